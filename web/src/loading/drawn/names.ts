/** Where a paint belongs; one for the face needs its landmarks. */
export type PaintKind = 'face' | 'body' | 'clothes';

/** A paint that is drawn for a cage: its name in links and projects, and its title for people. */
export interface DrawnPaint {
  name: string;
  title: string;
  kind: PaintKind;
}

/** The paints, in the order in which they are offered. */
export const drawnPaints: readonly DrawnPaint[] = [
  { name: 'tiger', title: 'Tiger', kind: 'body' },
  { name: 'skull', title: 'Skull', kind: 'face' },
  { name: 'soft-make-up', title: 'Soft make-up', kind: 'face' },
  { name: 'stage-make-up', title: 'Stage make-up', kind: 'face' },
  { name: 'freckles', title: 'Freckles', kind: 'face' },
  { name: 'tricolour', title: 'Tricolour', kind: 'clothes' },
  { name: 'club-colours', title: 'Club colours', kind: 'clothes' },
  { name: 'camouflage', title: 'Camouflage', kind: 'clothes' },
  { name: 'carbon', title: 'Carbon', kind: 'clothes' },
  { name: 'circuit', title: 'Circuit', kind: 'body' },
  { name: 'flowers', title: 'Flowers', kind: 'body' },
  { name: 'harlequin', title: 'Harlequin', kind: 'clothes' },
  { name: 'scales', title: 'Scales', kind: 'body' },
];
