import { execFileSync } from 'node:child_process';
import { existsSync } from 'node:fs';
import { type Browser, type BrowserServer, chromium, type LaunchOptions } from 'playwright-core';

/**
 * The list below the address bar: two pages of their own that each new window loads, with 400 requests. Together they are 6 of the 15
 * seconds of processor time that Chromium 156 takes until a first page is seen.
 */
const kAddressBar = ['WebUIOmniboxPopup', 'WebUIOmniboxAimPopup'];
/** Features that Playwright switches off, but for those of Windows and Edge. Chromium heeds only the last list of such features, so ours has to repeat them. */
const kOffByPlaywright = [
  'AimEnabled',
  'AvoidCorsURLLoaderRestartOnRedirect',
  'AvoidUnnecessaryBeforeUnloadCheckSync',
  'DestroyProfileOnBrowserClose',
  'HttpsFirstBalancedModeAutoEnable',
  'HttpsUpgrades',
  'LensOverlay',
  'MediaRouter',
  'NetworkTimeServiceQuerying',
  'OptimizationHints',
  'PaintHolding',
  'PreconnectToSearch',
  'ThirdPartyStoragePartitioning',
];
/** No background traffic, no first-run behaviour. */
const kQuiet = [
  '--no-sandbox',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
  `--disable-features=${[...kAddressBar, ...kOffByPlaywright].join(',')}`,
];
/** What draws, by the processor. Mesa's takes a third to a half of the time of Chromium's own, SwiftShader. */
export type Renderer = 'mesa' | 'swiftshader';
const kRenderer: Renderer = existsSync('/usr/share/glvnd/egl_vendor.d/50_mesa.json') ? 'mesa' : 'swiftshader';
/** Pages are composited without WebGL's renderer, which would compile shaders anew for each page: a quarter of the processor time. */
const kDrawing = ['--ignore-gpu-blocklist', '--disable-gpu-compositing'];
const kRenderers = {
  mesa: ['--use-angle=gl-egl'],
  swiftshader: ['--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
};
/** Only SwiftShader draws it. */
const kWebGpu = ['--enable-unsafe-webgpu', '--use-webgpu-adapter=swiftshader'];
/** Mesa without a screen, and not by the machine's graphics card. */
const kMesa = { EGL_PLATFORM: 'surfaceless', LIBGL_ALWAYS_SOFTWARE: '1', GALLIUM_DRIVER: 'llvmpipe' };

interface Look {
  /** Whether pages may draw with WebGL, by the processor. */
  drawing: boolean;
  /** Default: Mesa's, where Linux has it. */
  renderer?: Renderer | undefined;
  /** Whether they may draw with WebGPU, too. */
  webgpu?: boolean | undefined;
}

/**
 * Starts the Chromium that is installed, or the one that the environment variable CHROMIUM gives the path of.
 * @throws Error that says what to install, if there is none.
 */
export const launchChromium = (look: Look): Promise<Browser> => chromium.launch(optionsOf(look));

/** Starts a Chromium that draws, for `chromium.connect` of other processes: a start takes many seconds of processor time. */
export const serveChromium = (): Promise<BrowserServer> => chromium.launchServer(optionsOf({ drawing: true }));

const optionsOf = ({ drawing, renderer = kRenderer, webgpu = false }: Look): LaunchOptions => ({
  executablePath: process.env['CHROMIUM'] ?? installed(),
  args: [
    ...kQuiet,
    ...(drawing ? [...kDrawing, ...kRenderers[renderer]] : ['--disable-gpu']),
    ...(webgpu ? kWebGpu : []),
  ],
  env: { ...process.env, ...kMesa } as Record<string, string>,
});

function installed(): string {
  try {
    return execFileSync('sh', ['-c', 'command -v chromium'], { encoding: 'utf8' }).trim();
  } catch {
    throw new Error('Chromium is needed: install the package "chromium", or set CHROMIUM to the path of one.');
  }
}
