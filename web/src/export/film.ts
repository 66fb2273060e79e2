import type { Texture } from 'three';
import { RollOn } from '../view/overlay/roll-on';
import type { Viewer } from '../view/viewer';
import { type Card, drawCards } from './card';

const kSeconds = 5;
const kFrameRate = 30;
const kBitRate = 8e6; // per second
/** What players know best comes first. */
const kTypes = ['video/mp4;codecs=avc1.640028', 'video/mp4', 'video/webm;codecs=vp9', 'video/webm'];

/**
 * Records five seconds of what is on the stage as a card: the paint rolls on, and the model turns once, or plays its animation.
 * @param canvas    Shows it meanwhile.
 * @param paint     What the paint on the stage is in.
 * @param onSecond  Called with the seconds that are left.
 * @throws Error if the browser cannot encode it.
 */
export async function record(
  viewer: Viewer,
  { canvas, card, paint }: { canvas: HTMLCanvasElement; card: Card; paint: Texture },
  onSecond: (left: number) => void,
): Promise<Blob> {
  const { controls, stage } = viewer;
  const mimeType = kTypes.find((type) => MediaRecorder.isTypeSupported(type));
  if (!mimeType) throw new Error('the browser cannot encode films');
  const { angle } = controls;
  const turns = !stage.isPlaying;
  const rollOn = new RollOn(viewer, paint);
  const end = drawCards(viewer, canvas, card, 1);
  const recorder = new MediaRecorder(canvas.captureStream(kFrameRate), { mimeType, videoBitsPerSecond: kBitRate });
  const chunks: Blob[] = [];
  recorder.addEventListener('dataavailable', ({ data }) => chunks.push(data));
  const ended = new Promise<void>((done, fail) => {
    recorder.addEventListener('stop', () => done());
    recorder.addEventListener('error', () => fail(new Error('the browser stopped encoding it')));
  });
  if (turns) controls.turntable(kSeconds);
  let left = kSeconds;
  const clock = setInterval(() => (--left > 0 ? onSecond(left) : recorder.stop()), 1000);
  try {
    recorder.start();
    void rollOn.run();
    onSecond(left);
    await ended;
  } finally {
    clearInterval(clock);
    rollOn.end();
    end();
    if (turns) {
      controls.turntable(undefined);
      if (angle) controls.lookFrom(angle);
      else controls.home();
    }
    for (const track of recorder.stream.getTracks()) track.stop();
  }
  return new Blob(chunks, { type: mimeType.split(';')[0]! });
}
