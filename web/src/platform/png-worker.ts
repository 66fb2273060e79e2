import { answerBy } from './ask-worker';
import { encodePng } from './encode-png';

answerBy(encodePng);
