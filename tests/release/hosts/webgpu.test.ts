// What `webgpu.test.ts` of the package shows holds with WebGPU itself, too.
process.env['CAGECAST_BACKEND'] = 'webgpu';
await import('../../package/three/webgpu.test.js');

export {};
