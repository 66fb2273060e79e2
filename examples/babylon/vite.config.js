export default {
  base: './',
  // The sample models of the repository lie beside the page.
  publicDir: '../samples/lizard',
  build: { target: 'es2022' },
  // Only because cagecast is a link to the repository: files outside the example's folder.
  server: { fs: { allow: ['../..'] } },
};
