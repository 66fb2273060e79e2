import { element } from '../platform/page';
import { objectOf, textOf } from '../state/project/checks';
import type { Contribution } from '../state/project/project';

/** Fields of the painting tools. */
const kFields = ['color', 'size', 'hardness', 'opacity', 'mirror'].map((name) => `brush-${name}`);

/** The settings of the painting tools, as projects have them. */
export const brushPart: Contribution = {
  name: 'brush',
  isWork: false,
  save: () =>
    Object.fromEntries(
      kFields.map((id) => {
        const { type, checked, value } = element(id, HTMLInputElement);
        return [id, type === 'checkbox' ? checked : value];
      }),
    ),
  read(saved) {
    const values = objectOf(saved, 'brush');
    return {
      shown() {
        for (const id of kFields) {
          const field = element(id, HTMLInputElement);
          if (field.type === 'checkbox') field.checked = values[id] === true;
          // Fields replace what they cannot hold.
          else field.value = textOf(values[id], field.value);
          field.dispatchEvent(new Event('input', { bubbles: true }));
        }
      },
    };
  },
};
