import { testScenes } from '../three/run-scenes.js';

await testScenes('tests/package/react/page.tsx', {
  jsx: 'automatic',
  folders: ['examples/samples'],
  harmless: /THREE.Clock: This module has been deprecated/, // which react-three-fiber uses
});
