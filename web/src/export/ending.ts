/** The ending of the name of the file that a model is saved as: a VRM stays one. */
export const endingOf = (name: string): 'glb' | 'vrm' => (/\.vrm$/i.test(name) ? 'vrm' : 'glb');
