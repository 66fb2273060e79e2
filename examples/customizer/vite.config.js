// The sample models, made by `npm run assets`.
export default { publicDir: '../../build/assets/lizard' };
