/** A paint that is drawn for a cage: its name in links and projects, and its title for people. */
export interface DrawnPaint {
  name: string;
  title: string;
  /** Whether it needs the landmarks of a face. */
  ofFaces?: true;
}

/** The paints, in the order in which they are offered. */
export const drawnPaints: readonly DrawnPaint[] = [
  { name: 'tiger', title: 'Tiger' },
  { name: 'skull', title: 'Skull', ofFaces: true },
  { name: 'soft-make-up', title: 'Soft make-up', ofFaces: true },
  { name: 'stage-make-up', title: 'Stage make-up', ofFaces: true },
  { name: 'freckles', title: 'Freckles', ofFaces: true },
  { name: 'tricolour', title: 'Tricolour' },
  { name: 'club-colours', title: 'Club colours' },
  { name: 'camouflage', title: 'Camouflage' },
  { name: 'carbon', title: 'Carbon' },
  { name: 'circuit', title: 'Circuit' },
  { name: 'flowers', title: 'Flowers' },
  { name: 'harlequin', title: 'Harlequin' },
  { name: 'scales', title: 'Scales' },
];
