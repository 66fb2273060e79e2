import type { Page } from 'playwright-core';

const kStageSizes = [
  [320, 568],
  [360, 740],
  [390, 664],
  [390, 844],
  [640, 360],
  [640, 400],
  [844, 390],
  [768, 1024],
  [900, 700],
  [1100, 800],
  [1280, 800],
] as const;

const kStageControls =
  ':is(.masthead, .stage-head, .quick, .angles, .clips, .halves, .sticker-bar) :is(button, input, select), :is(.rail, .toolbar) label, .knob';
const kStageGroups = '.masthead button, .stage-head > *, .rail, .quick, .angles, .clips, .toolbar, .sticker-bar';

/** What can be pressed on the stage but is outside the window or covered, and groups of controls that overlap, at all sizes. */
export async function stageFaults(
  page: Page,
  sizes: readonly (readonly [number, number])[] = kStageSizes,
): Promise<string[]> {
  const faults: string[] = [];
  for (const [width, height] of sizes) {
    await page.setViewportSize({ width, height });
    await page.evaluate(() => {
      scrollTo(0, 0);
      // What follows the size does in the next frame.
      return new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)));
    });
    const found = await page.evaluate(
      ([controls, groups]) => {
        const faults: string[] = [];
        for (const control of document.querySelectorAll<HTMLElement>(controls)) {
          if (!control.checkVisibility({ visibilityProperty: true })) continue;
          const { left, right, top, bottom } = control.getBoundingClientRect();
          const name = control.id || control.textContent!.trim() || control.className;
          if (left < 0 || top < 0 || right > innerWidth || bottom > innerHeight) faults.push(`${name} is cut off`);
          const hit = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
          if (!control.contains(hit)) faults.push(`${name} is covered by ${hit?.outerHTML.slice(0, 60)}`);
        }
        const boxes = [...document.querySelectorAll(groups)]
          .filter((group) => group.checkVisibility())
          .map((group) => ({ name: group.id || group.className, box: group.getBoundingClientRect() }));
        for (const [i, { name, box: a }] of boxes.entries())
          for (const { name: other, box: b } of boxes.slice(i + 1))
            if (a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 && b.top < a.bottom - 1)
              faults.push(`${name} overlaps ${other}`);
        return faults;
      },
      [kStageControls, kStageGroups] as const,
    );
    faults.push(...found.map((fault) => `${width} × ${height}: ${fault}`));
  }
  return faults;
}
