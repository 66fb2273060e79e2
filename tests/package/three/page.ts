// The page of the tests. Runs in the browser.
import { init } from 'cagecast';
import { channelScenes } from './channel-scenes';
import { layerScenes } from './layer-scenes';
import { lookScenes } from './look-scenes';
import { materialScenes } from './material-scenes';
import { painterScenes } from './painter-scenes';
import { offer } from './scenes';
import { sharingScenes } from './sharing-scenes';

await init();
offer({ ...materialScenes, ...sharingScenes, ...layerScenes, ...channelScenes, ...lookScenes, ...painterScenes });
