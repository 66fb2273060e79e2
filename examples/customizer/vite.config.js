export default {
  base: './',
  // The sample models of the repository lie beside the page.
  publicDir: '../samples/lizard',
  build: { target: 'es2022' },
  // Only because cagecast is a link to the repository: the page's own three.js, and files outside the example's folder.
  resolve: { dedupe: ['three'] },
  server: { fs: { allow: ['../..'] } },
};
