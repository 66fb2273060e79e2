import { requireGraphics } from '../platform/graphics';
import type { Viewer } from '../view/viewer';

const kSeconds = 5;
const kFrameRate = 30;
const kBitRate = 8e6; // per second
/** What players know best comes first. */
const kTypes = ['video/mp4;codecs=avc1.640028', 'video/mp4', 'video/webm;codecs=vp9', 'video/webm'];

/**
 * Records five seconds of what is on the stage: the animation that is played, or one turn of the model.
 * @param background  Behind the model, as #rrggbb; empty for the colour of the page, as films have no transparency.
 * @param onSecond    Called with the seconds that are left.
 * @throws Error if the browser cannot draw or encode it.
 */
export async function record(viewer: Viewer, background: string, onSecond: (left: number) => void): Promise<Blob> {
  const { renderer, controls, stage, studio } = viewer;
  requireGraphics(renderer);
  const mimeType = kTypes.find((type) => MediaRecorder.isTypeSupported(type));
  if (!mimeType) throw new Error('the browser cannot encode films');
  const { angle } = controls;
  const recorder = new MediaRecorder(renderer.domElement.captureStream(kFrameRate), {
    mimeType,
    videoBitsPerSecond: kBitRate,
  });
  const chunks: Blob[] = [];
  recorder.addEventListener('dataavailable', ({ data }) => chunks.push(data));
  const ended = new Promise<void>((done, fail) => {
    recorder.addEventListener('stop', () => done());
    recorder.addEventListener('error', () => fail(new Error('the browser stopped encoding it')));
  });
  const turns = !stage.isPlaying;
  const isDark = matchMedia('(prefers-color-scheme: dark)').matches;
  studio.setBackground(background || (isDark ? '#20252d' : '#eef1f4'));
  if (turns) controls.turntable(kSeconds);
  let left = kSeconds;
  const clock = setInterval(() => (--left > 0 ? onSecond(left) : recorder.stop()), 1000);
  try {
    recorder.start();
    onSecond(left);
    await ended;
  } finally {
    clearInterval(clock);
    studio.setBackground(background);
    if (turns) {
      controls.turntable(undefined);
      if (angle) controls.lookFrom(angle);
      else controls.home();
    }
    for (const track of recorder.stream.getTracks()) track.stop();
  }
  return new Blob(chunks, { type: mimeType.split(';')[0]! });
}
