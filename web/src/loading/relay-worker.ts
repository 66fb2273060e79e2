import { init, type Mesh, type TransferOptions } from 'cagecast';
import { type Baked, type Image, relayPaint } from 'cagecast/engines';
import { answerBy } from '../platform/ask-worker';

/** A paint that is to be carried from one cage of a model to another. */
export interface RelayRequest {
  image: Image;
  from: Mesh;
  to: Mesh;
  model: Mesh;
  transfer: TransferOptions;
}

answerBy(
  async ({ image, from, to, model, transfer }: RelayRequest) => {
    await init();
    return relayPaint(image, from, to, model, { transfer });
  },
  ({ data }: Baked) => [data.buffer],
);
