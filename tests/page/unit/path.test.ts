import assert from 'node:assert/strict';
import path from 'node:path';
import { before, test } from 'node:test';
import { init, presetOptions, project } from 'cagecast';
import { BoundaryLoops } from '../../../web/src/explain/boundary-loops';
import { type Path, pathOf } from '../../../web/src/explain/path';
import { diagonalOf } from '../../../web/src/state/surface';
import { modelFolders, readPlain } from '../../package/scenes';

/** The visibility that each outcome is. */
const kVisibility: Record<Path['outcome'], number> = { covered: 0, pokesOut: 0, hidden: 1, lost: 2 };
const kAsked = 600; // vertices of each model

before(() => init());

for (const folder of modelFolders()) {
  test(`${path.basename(folder)}: the path of a vertex leads to what the transfer finds`, async () => {
    const [target, cage] = await Promise.all(
      ['target', 'cage'].map((name) => readPlain(path.join(folder, `${name}.glb`))),
    );
    const loops = new BoundaryLoops(cage!);
    const diagonal = diagonalOf(target!);
    for (const preset of ['default', 'paper'] as const) {
      const { visibility, triangles, distances } = project(cage!, target!, { preset });
      const every = Math.max(1, Math.floor(visibility.length / kAsked));
      for (let vertex = 0; vertex < visibility.length; vertex += every) {
        const path = pathOf(
          { target: target!, cage: cage!, loops },
          { vertex, triangle: triangles[vertex]!, diagonal },
          presetOptions(preset),
        );
        assert.equal(kVisibility[path.outcome], visibility[vertex], `${preset}: vertex ${vertex} is ${path.outcome}`);
        assert.ok(
          Math.abs(path.start.distanceTo(path.closest) - distances[vertex]!) < 1e-6 * diagonal,
          `${preset}: vertex ${vertex} is as far away`,
        );
      }
    }
  });
}
