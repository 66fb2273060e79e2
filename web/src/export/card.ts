import type { View } from '../state/view-state';
import type { Viewer } from '../view/viewer';

/** Pixels of a card: what networks show whole in a column of posts. */
const kSize = { width: 1080, height: 1350 };
/** What the model keeps clear of, the name below it too. */
const kFree = { ...kSize, top: 60, bottom: 190, side: 50, fill: 0.9 };

/** A picture of the model with its name, to be shared. */
export interface Card {
  name: string;
  /** Behind the model, as #rrggbb; empty for the colours of the stage. */
  background: string;
  /** Without background and name. */
  isClear: boolean;
  view: View;
}

/**
 * Draws each frame of the stage as a card.
 * @param ratio Of the canvas to the size of a card.
 * @returns Ends it.
 */
export function drawCards(viewer: Viewer, canvas: HTMLCanvasElement, card: Card, ratio: number): () => void {
  canvas.width = ratio * kSize.width;
  canvas.height = ratio * kSize.height;
  viewer.studio.setBackground('');
  const end = viewer.hold({
    ...{ free: kFree, ratio, view: card.view },
    onDrawn: () => compose(canvas, viewer.renderer.domElement, card),
  });
  return () => {
    viewer.studio.setBackground(card.view.background);
    end();
  };
}

function compose(canvas: HTMLCanvasElement, model: HTMLCanvasElement, { name, background, isClear }: Card): void {
  const { width, height } = canvas;
  const context = canvas.getContext('2d')!;
  context.clearRect(0, 0, width, height);
  const isDark = background ? isDarkColor(background) : matchMedia('(prefers-color-scheme: dark)').matches;
  if (!isClear) {
    const [x, y] = [width / 2, 0.42 * height];
    const stage = context.createRadialGradient(x, y, 0, x, y, 0.7 * height);
    (isDark ? ['#2f353f', '#12151a'] : ['#ffffff', '#d5dbe2']).forEach((color, at) => stage.addColorStop(at, color));
    context.fillStyle = background || stage;
    context.fillRect(0, 0, width, height);
  }
  context.drawImage(model, 0, 0, width, height);
  if (isClear) return;
  context.fillStyle = isDark ? '#eceff3' : '#0f1216';
  const write = (text: string, weight: number, size: number, y: number): void => {
    context.font = `${weight} ${size * height}px Figtree, system-ui, sans-serif`;
    context.fillText(text, 0.06 * width, y * height, 0.88 * width);
  };
  write(name, 600, 0.046, 0.92);
  context.globalAlpha = 0.7;
  write('Cagecast', 450, 0.026, 0.963);
  context.globalAlpha = 1;
}

/** @param color As #rrggbb. */
function isDarkColor(color: string): boolean {
  const [red = 0, green = 0, blue = 0] = [1, 3, 5].map((at) => Number.parseInt(color.slice(at, at + 2), 16));
  return 0.3 * red + 0.59 * green + 0.11 * blue < 140;
}
