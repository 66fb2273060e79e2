import type * as React from 'react';
import type { CagecastViewer } from './element.js';
import type { ViewerEvents } from './events.js';

type Text = string | number | undefined;

/** The attributes of `<cagecast-viewer>`, and its events, by which React listens: `onverdict`. */
export interface ViewerAttributes {
  target?: string | undefined;
  cage?: string | undefined;
  paint?: string | undefined;
  opacity?: Text;
  feather?: Text;
  preset?: 'default' | 'paper' | undefined;
  threshold?: Text;
  borders?: 'triangle' | 'cut' | undefined;
  motion?: 'true' | 'false' | undefined;
  ignore?: string | undefined;
  keep?: string | undefined;
  exclude?: string | undefined;
  'camera-orbit'?: string | undefined;
  alt?: string | undefined;
  poster?: string | undefined;
  check?: boolean | undefined;
  onprogress?: ((event: ViewerEvents['progress']) => void) | undefined;
  onload?: ((event: ViewerEvents['load']) => void) | undefined;
  onverdict?: ((event: ViewerEvents['verdict']) => void) | undefined;
  onerror?: ((event: ViewerEvents['error']) => void) | undefined;
}

declare module 'react' {
  namespace JSX {
    interface IntrinsicElements {
      'cagecast-viewer': React.DetailedHTMLProps<React.HTMLAttributes<CagecastViewer>, CagecastViewer> &
        ViewerAttributes;
    }
  }
}
