/** Makes an element. @param properties Of the element. @param content Texts and elements in it. */
export function make<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  properties: Partial<HTMLElementTagNameMap[Tag]> = {},
  ...content: readonly (string | Node)[]
): HTMLElementTagNameMap[Tag] {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...content);
  return made;
}

/** Makes a swatch of colours. @param background As in CSS. */
export function swatch(background: string): HTMLElement {
  const made = make('i', { className: 'swatch' });
  made.style.background = background;
  return made;
}
