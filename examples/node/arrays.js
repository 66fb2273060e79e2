// Transfers UVs to raw arrays: a square of four vertices under a cage of one large triangle.
import { init, transfer, Zone } from 'cagecast';

await init();
const cage = {
  positions: new Float32Array([-1, -1, 0.1, 3, -1, 0.1, -1, 3, 0.1]),
  indices: new Uint32Array([0, 1, 2]),
  uvs: new Float32Array([0, 0, 1, 0, 0, 1]),
};
const square = {
  positions: new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]),
  indices: new Uint32Array([0, 1, 2, 0, 2, 3]),
};

const { uvs, zones } = transfer(cage, square);
zones.forEach((zone, v) => {
  console.log(
    `vertex ${v}: u = ${uvs[2 * v]}, v = ${uvs[2 * v + 1]}, ${zone === Zone.Cosmetic ? 'may be painted' : 'must stay bare'}`,
  );
});
