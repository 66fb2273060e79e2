import 'cagecast/viewer';

const find = (selector) => document.querySelector(selector);
const viewer = find('cagecast-viewer');
const say = (text) => {
  find('[role=status]').textContent = text;
};
viewer.addEventListener('progress', ({ detail }) => say(`${detail.stage}: ${Math.round(100 * detail.share)} %`));
viewer.addEventListener('verdict', ({ detail }) => say(`The cage is ${detail.verdict}.`));
viewer.addEventListener('load', () => {
  document.title = '1 painted';
});
find('select').addEventListener('change', ({ target }) => viewer.setAttribute('paint', target.value));
find('input').addEventListener('input', ({ target }) => viewer.setAttribute('opacity', target.value));
find('button').addEventListener('click', async () => {
  const url = URL.createObjectURL(new Blob([await viewer.exportGlb()], { type: 'model/gltf-binary' }));
  Object.assign(document.createElement('a'), { href: url, download: 'painted.glb' }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
});
