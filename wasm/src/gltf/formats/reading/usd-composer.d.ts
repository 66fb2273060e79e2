declare module 'three/addons/loaders/usd/USDComposer.js' {
  export class USDComposer {}
}
