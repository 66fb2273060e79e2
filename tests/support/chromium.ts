import { execFileSync } from 'node:child_process';
import { type Browser, chromium } from 'playwright-core';

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
/**
 * Software rendering. Pages are composited without WebGL's renderer, which would compile shaders anew for each page: a quarter of the
 * processor time of these tests.
 */
const kDrawing = [
  '--use-angle=swiftshader',
  '--enable-unsafe-swiftshader',
  '--ignore-gpu-blocklist',
  '--disable-gpu-compositing',
];

/**
 * Starts the Chromium that is installed, or the one that the environment variable CHROMIUM gives the path of.
 * @param drawing Whether pages may draw with WebGL, by the processor.
 * @throws Error that says what to install, if there is none.
 */
export function launchChromium({ drawing }: { drawing: boolean }): Promise<Browser> {
  return chromium.launch({
    executablePath: process.env['CHROMIUM'] ?? installed(),
    args: [...kQuiet, ...(drawing ? kDrawing : ['--disable-gpu'])],
  });
}

function installed(): string {
  try {
    return execFileSync('sh', ['-c', 'command -v chromium'], { encoding: 'utf8' }).trim();
  } catch {
    throw new Error('Chromium is needed: install the package "chromium", or set CHROMIUM to the path of one.');
  }
}
