import type { WebGLRenderer } from 'three';

const nothing = (): void => {};
const gl = new Proxy({}, { get: () => nothing });

/** The number of the frame. */
export const frame = { frame: 0 };

/** A renderer that draws nothing, for tests without WebGL. */
export const renderer = {
  info: { render: frame },
  domElement: new EventTarget(),
  xr: {},
  properties: { get: () => ({}) },
  state: { bindFramebuffer: nothing, setScissorTest: nothing },
  getContext: () => gl,
  getRenderTarget: () => null,
  getActiveCubeFace: () => 0,
  getActiveMipmapLevel: () => 0,
  setRenderTarget: nothing,
  readRenderTargetPixels: nothing,
  copyTextureToTexture: nothing,
  initRenderTarget: nothing,
  clear: nothing,
  render: nothing,
} as unknown as WebGLRenderer;

/** Bytes that a call allocates once it is compiled: the least of several rounds but those in which garbage was collected. */
export function allocatedBy(call: () => void): number {
  const calls = 2000;
  for (let i = 0; i < 50 * calls; ++i) call();
  const rounds = Array.from({ length: 9 }, () => {
    const before = process.memoryUsage().heapUsed;
    for (let i = 0; i < calls; ++i) call();
    return (process.memoryUsage().heapUsed - before) / calls;
  });
  return Math.min(...rounds.filter((bytes) => bytes >= 0));
}
