import { download } from '../../platform/download';
import { make } from '../../platform/make';
import { element, showError } from '../../platform/page';
import type { Session } from '../../state/session';
import { methodsCsv } from '../../state/study/csv';
import type { Study } from '../../state/study/study';
import type { Half } from '../../state/view-state';

/** What the ways to transfer are called. */
export const kMethodNames: Readonly<Record<Half, string>> = {
  naive: 'Naive',
  occlusion: 'Occlusion rays only',
  rays: 'No segment rule',
  paper: 'Paper',
  default: 'Default',
  result: 'Cagecast, as set',
};

const kLabelled =
  'By the labels of this model: vertices that are painted and must not be, and their share of the area that must stay bare; then the share of the rest that stays bare.';
const kUnlabelled = 'What must not be painted is not known: open labels, such as those of the benchmark.';

/** Shows what each way to transfer paints and, with labels, how much of that is wrong. */
export function showMethods(session: Session, study: Study): void {
  const rows = element('method-rows', HTMLTableSectionElement);
  const show = (): void => {
    const found = study.found;
    rows.replaceChildren(
      ...found.map(({ method, painted, score }) => {
        const shares = score ? [score.wrongArea, score.bareArea].map(percent) : ['–', '–'];
        const cells = [painted.toLocaleString('en'), score?.wrong.toLocaleString('en') ?? '–', ...shares];
        const row = make('tr', {}, make('th', { scope: 'row' }, kMethodNames[method]));
        row.append(...cells.map((text) => make('td', {}, text)));
        row.dataset.method = method;
        return row;
      }),
    );
    const isLabelled = found.some(({ score }) => score);
    element('methods-note', HTMLElement).textContent =
      found.length === 0 ? 'Comparing…' : isLabelled ? kLabelled : kUnlabelled;
  };
  for (const event of ['decided', 'labels'] as const) study.on(event, show);
  session.on('zones', show);
  element('methods-csv', HTMLButtonElement).addEventListener('click', () => {
    const { name } = session.shown!.target;
    download(new Blob([methodsCsv(study.found)], { type: 'text/csv' }), `${name}-methods.csv`);
  });
  const input = element('labels-input', HTMLInputElement);
  input.addEventListener('change', async () => {
    const [file] = input.files ?? [];
    try {
      if (file && session.shown) await study.label(file);
    } catch (error) {
      showError((error as Error).message);
    }
    input.value = ''; // the same file may come again
  });
}

const percent = (share: number): string => `${(100 * share).toFixed(1)} %`;
