// Of the 52 face shapes of ARKit: what they move; a side follows at the end of the name.
const kPaired = new Set(['eye', 'brow', 'cheek']);
const kArKit = /^(eye|brow|cheek|jaw|mouth|nose|tongue)([A-Z][A-Za-z]*)$/;
// Of VRoid: Fcl_EYE_Close_L, Fcl_MTH_A.
const kVRoid = /^Fcl_(ALL|BRW|EYE|MTH|HA)_(\w+?)(?:_([LR]))?$/;
const kVRoidParts: Record<string, string> = { ALL: 'Face', BRW: 'Brows', EYE: 'Eyes', MTH: 'Mouth', HA: 'Teeth' };

// Names of expressions of VRM 0 with another name in VRM 1, and those that are no words.
const kVrm: Record<string, string> = {
  joy: 'happy',
  sorrow: 'sad',
  fun: 'relaxed',
  a: 'aa',
  i: 'ih',
  u: 'ou',
  e: 'ee',
  o: 'oh',
  blink_l: 'blinkLeft',
  blink_r: 'blinkRight',
};

const capitalized = (text: string): string => text[0]!.toUpperCase() + text.slice(1);
const words = (name: string): string => name.replace(/([a-z])(?=[A-Z])/g, '$1 ').toLowerCase();

/** A morph's name in words, such as “Left eye: blink” for `eyeBlinkLeft`; names of no known kind stay as they are. */
export function titleOfMorph(name: string): string {
  const [, of, what, side] = kVRoid.exec(name) ?? [];
  if (of && what) {
    const text = what.length === 1 ? what : words(what.replaceAll('_', ' '));
    return `${kVRoidParts[of]}: ${text}${side ? `, ${side === 'L' ? 'left' : 'right'}` : ''}`;
  }
  const [, part, rest] = kArKit.exec(name) ?? [];
  if (!part || !rest) return name;
  const [, action, at] = /^(.+?)(Left|Right)$/.exec(rest) ?? [];
  if (!action || !at) return `${capitalized(part)}: ${words(rest)}`;
  return kPaired.has(part)
    ? `${at} ${part}: ${words(action)}`
    : `${capitalized(part)}: ${words(action)}, ${at.toLowerCase()}`;
}

/** An expression's name in words; the names of VRM 0 and VRM 1 for the same are one. */
export function titleOfExpression(name: string): string {
  return capitalized(words(kVrm[name.toLowerCase()] ?? name));
}
