/** Describes a value of the wrong type, for messages. */
export const describe = (value: unknown): string =>
  typeof value === 'string' ? `"${value}"` : typeof value === 'object' && value ? 'an object' : String(value);
