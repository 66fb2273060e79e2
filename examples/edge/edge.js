// An edge function: a model, a paint and a template or a cage in, the painted model out. It compiles and fetches nothing.
import { init } from 'cagecast';
import module from 'cagecast/cagecast.wasm';
import cagesModule from 'cagecast/cagecast-cages.wasm';
import * as cages from 'cagecast/cages';
import { paintGlb } from 'cagecast/gltf';
import head from 'cagecast/templates/human-head.glb';

const ready = Promise.all([init({ module }), cages.init({ module: cagesModule })]);

export default {
  /** Takes a form with the files `model`, `paint` and, if it is not to be a fitted head, `cage`. */
  async fetch(request) {
    try {
      await ready;
      const form = await request.formData();
      const bytesOf = async (name) => new Uint8Array(await form.get(name).arrayBuffer());
      const around = form.has('cage') ? { cage: await bytesOf('cage') } : { template: new Uint8Array(head) };
      const { bytes, verdict } = await paintGlb(await bytesOf('model'), { ...around, texture: await bytesOf('paint') });
      return new Response(bytes, { headers: { 'content-type': 'model/gltf-binary', 'x-verdict': verdict } });
    } catch (error) {
      return new Response(error.message, { status: 400 });
    }
  },
};
