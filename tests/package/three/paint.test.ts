import { testScenes } from './run-scenes.js';

/** The three.js of these scenes, as package.json names it; `oldest-three.test.ts` gives another. */
const three = process.env['CAGECAST_THREE'] ?? 'three';

await testScenes('tests/package/three/page.ts', three === 'three' ? {} : { alias: { three } });
