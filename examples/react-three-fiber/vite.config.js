// The sample models, made by `npm run assets` in the repository, lie beside the page.
export default { base: './', publicDir: '../../build/assets/lizard', build: { target: 'es2022' } };
