import { VRMLoaderPlugin, VRMUtils } from '@pixiv/three-vrm';
import { Canvas, useLoader, useThree } from '@react-three/fiber';
import { loadTemplate } from 'cagecast/cages';
import { paintGlb } from 'cagecast/gltf';
import { useCagecast, useLayers, usePainter } from 'cagecast/react';
import { StrictMode, Suspense, useEffect, useLayoutEffect, useState, useTransition } from 'react';
import { createRoot } from 'react-dom/client';
import { Box3, DataTexture, SRGBColorSpace, Vector3 } from 'three';
import { GLTFLoader } from 'three/addons/loaders/GLTFLoader.js';

const template = await loadTemplate('human-head');
const white = new DataTexture(new Uint8Array(4).fill(255), 1, 1);
Object.assign(white, { colorSpace: SRGBColorSpace, needsUpdate: true });
const makeup = { lips: '#b01030', cheeks: '#e05070', eyelids: '#3050a0' };
const register = (loader) => loader.register((parser) => new VRMLoaderPlugin(parser));
const bytesOf = async (source) => new Uint8Array(await (await source).arrayBuffer());
const download = (bytes, name) =>
  Object.assign(document.createElement('a'), { href: URL.createObjectURL(new Blob([bytes])), download: name }).click();

function Avatar({ url, layers, look, onPainted }) {
  const avatar = useLoader(GLTFLoader, url, register);
  useLayoutEffect(() => () => VRMUtils.deepDispose(avatar.scene), [avatar]); // geometries before their paint
  const painted = useCagecast(avatar, { template, layers });
  usePainter(painted, { tool: look.tool, brush: { color: look.color, size: 0.04 } });
  const { camera } = useThree();
  useEffect(() => {
    const box = new Box3().setFromArray(painted.cage.positions);
    box.getCenter(camera.position).z += 1.3 * box.getSize(new Vector3()).y;
    onPainted(painted.applied && { url, ...painted });
  }, [painted.applied]);
  return <primitive object={avatar.scene} />;
}

function Customizer({ look, ...avatar }) {
  const layer = ([region, tint]) => ({ name: region, texture: white, region, tint, opacity: Number(look[region]) });
  const layers = useLayers(Object.entries(makeup).map(layer), { cage: template });
  return <Suspense>{layers && <Avatar {...{ layers, look, ...avatar }} />}</Suspense>;
}

function App() {
  const [look, setLook] = useState({ tool: 'brush', color: '#20a060', lips: 0.8, cheeks: 0.4, eyelids: 0.6 });
  const [url, setUrl] = useState('avatar.vrm');
  const [isLoading, startTransition] = useTransition();
  const [painted, setPainted] = useState();
  const change = async ({ target: { name, value, files } }) => {
    if (name === 'avatar') startTransition(() => setUrl(URL.createObjectURL(files[0])));
    else if (name === 'look') painted.layers.load(JSON.parse(await files[0].text()));
    else setLook({ ...look, [name]: value });
  };
  useEffect(() => () => painted && useLoader.clear(GLTFLoader, painted.url), [painted?.url]); // it is not shown any more
  const slider = (name) => ({ name, type: 'range', max: 1, step: 0.05, defaultValue: look[name] });
  const save = async () => download(JSON.stringify(await painted.layers.save()), 'look.json');
  const exportVrm = async () => {
    const canvas = new OffscreenCanvas(1024, 1024);
    canvas.getContext('2d').putImageData(painted.layers.toImageData(1024), 0, 0);
    const texture = await bytesOf(canvas.convertToBlob());
    download((await paintGlb(await bytesOf(fetch(url)), { cage: painted.cage, texture })).bytes, 'painted.vrm');
  };
  document.title = painted?.url === url && !isLoading ? `${painted.applied.parts.length} painted` : 'Loading';
  return (
    <>
      <Canvas>
        <hemisphereLight intensity={3} />
        <Customizer {...{ look, url }} onPainted={setPainted} />
      </Canvas>
      <form onChange={change}>
        <label>Avatar <input name="avatar" type="file" accept=".glb,.vrm" /></label>
        <label>Look <input name="look" type="file" accept=".json" /></label>
        <label>Tool <select name="tool"><option>brush</option><option>eraser</option></select></label>
        <label>Colour <input name="color" type="color" defaultValue={look.color} /></label>
        {Object.keys(makeup).map((name) => <label key={name}>{name} <input {...slider(name)} /></label>)}
        <button type="button" onClick={() => painted.layers.undo()}>Undo</button>
        <button type="button" onClick={save}>Save</button>
        <button type="button" onClick={exportVrm}>Export</button>
      </form>
    </>
  );
}
createRoot(document.querySelector('#root')).render(<StrictMode><App /></StrictMode>);
