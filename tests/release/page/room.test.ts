import assert from 'node:assert/strict';
import { test } from 'node:test';
import { faults } from '../../support/axe';
import { difference, frames, look, modelArea, watch } from '../../support/picture';
import { openSite, shownError } from '../../support/site';

const site = await openSite();

/** A device that shows models in the room, or refuses to; its camera is 0.3 m above the floor. */
const device = (answer: string): string => `
  const matrix = new Float32Array([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.3, 0, 1]);
  const view = { eye: 'none', transform: { matrix }, projectionMatrix: new Float32Array([1.7, 0, 0, 0, 0, 1.7, 0, 0, 0, 0, -1, -1, 0, 0, -0.04, 0]) };
  const frame = {
    getViewerPose: () => ({ views: [view] }),
    // Towards a spot on the floor, to the right of the model.
    getPose: () => ({ transform: { matrix: [1, 0, 0, 0, 0, 1, 0, 0, -0.4, 0.3, 1.5, 0], position: { x: 0, y: 0.3, z: 0 } } }),
  };
  delete window.XRWebGLBinding;
  WebGL2RenderingContext.prototype.makeXRCompatible = async () => {};
  window.XRWebGLLayer = class {
    framebuffer = null; // that of the canvas, so that it is seen
    constructor(session, { canvas: { width, height } }) {
      Object.assign(this, { framebufferWidth: width, framebufferHeight: height });
    }
    getViewport() { return { x: 0, y: 0, width: this.framebufferWidth, height: this.framebufferHeight }; }
  };
  window.faked = Object.assign(new EventTarget(), {
    inputSources: [],
    updateRenderState() {},
    requestReferenceSpace: async (type) => ({ type }),
    requestAnimationFrame: (draw) => requestAnimationFrame((now) => draw(now, frame)),
    cancelAnimationFrame: (id) => cancelAnimationFrame(id),
    end: async () => void faked.dispatchEvent(new Event('end')),
    tap: () => void faked.dispatchEvent(Object.assign(new Event('select'), { frame, inputSource: {} })),
  });
  const xr = {
    isSessionSupported: async (mode) => mode === 'immersive-ar',
    requestSession: async (mode, { requiredFeatures }) => {
      window.requested = [mode, ...requiredFeatures];
      ${answer}
    },
  };
  Object.defineProperty(navigator, 'xr', { value: xr });`;

const kView = '#sample=lizard&view=result';

test('where a device can show it, the painted model is in the room: on the floor in front, where one taps; then all is as before', async () => {
  const chunks: string[] = [];
  const { page, complaints } = await site.visit({}, device('return window.faked;'), kView);
  page.on('request', (request) => void chunks.push(request.url()));
  const area = await modelArea(page);
  const before = await look(page, area);
  const button = page.getByTestId('show-room');
  await button.waitFor();
  assert.deepEqual(await faults(page), []);
  assert.ok((await button.boundingBox())!.height >= 44);
  await button.click();
  await watch(page, area, (seen) => difference(before, seen) > 0.1);
  assert.equal(chunks.filter((url) => /\/room-/.test(url)).length, 1, 'its code loads when it is asked for');
  assert.deepEqual(await page.evaluate('requested'), ['immersive-ar', 'local-floor']);
  await frames(page, 3);
  const inRoom = await look(page, area);

  await page.evaluate('faked.tap()');
  await watch(page, area, (seen) => difference(inRoom, seen) > 0.05);

  await page.evaluate('faked.end()');
  await watch(page, area, (seen) => difference(before, seen) < 0.001);
  await page.locator('#view').press('ArrowLeft');
  await watch(page, area, (seen) => difference(before, seen) > 0.01);
  assert.equal(await shownError(page), '');
  assert.deepEqual(complaints, []);
});

test('where a device refuses, that is said in one sentence, and nothing else has changed', async () => {
  const refusal = "throw new DOMException('The user denied some of the requested permissions.', 'NotAllowedError');";
  const { page, complaints } = await site.visit({}, device(refusal), kView);
  const area = await modelArea(page);
  const before = await look(page, area);
  await page.getByTestId('show-room').click();
  await page.locator('#error', { hasText: /./ }).waitFor();
  assert.equal(
    await shownError(page),
    'The model cannot be shown in your room: the browser was not allowed to use the camera.',
  );
  await page.locator('#alert-close').click();
  assert.ok(difference(before, await look(page, area)) < 0.001);
  assert.deepEqual(complaints, []);
});

test('where no device can show it, it is not offered', async () => {
  for (const xr of ['undefined', '{ isSessionSupported: async () => false }']) {
    const { page, complaints } = await site.visit({}, `Object.defineProperty(navigator, 'xr', { value: ${xr} });`);
    assert.ok(await page.getByTestId('save-picture').isVisible());
    assert.ok(await page.getByTestId('show-room').isHidden());
    assert.deepEqual(complaints, []);
  }
});
