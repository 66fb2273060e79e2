export default {
  base: './',
  publicDir: '../three-vrm/models', // which make-avatar.js makes
  build: { target: 'es2022' },
  // Only because cagecast is a link to the repository: the page's own three.js and React, and files outside the example's folder.
  resolve: { dedupe: ['three', 'react', '@react-three/fiber'] },
  server: { fs: { allow: ['../..'] } },
};
