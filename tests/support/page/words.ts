import { readFileSync } from 'node:fs';
import type { Page } from 'playwright-core';
import { Dictionary } from '../../../web/src/platform/dictionary';
import { inRepository } from '../site';

/** Languages that the page is translated to. */
export const kLanguages = ['de', 'ja'] as const;
export type Language = (typeof kLanguages)[number];

/** The dictionary of a language. @param onLeft  As in `Dictionary`. */
export const dictionaryOf = (language: Language, onLeft?: (words: string) => void): Dictionary =>
  new Dictionary(JSON.parse(readFileSync(inRepository(`web/src/words/${language}.json`), 'utf8')), onLeft);

/** A script to run before the page's own: it collects all texts of the document that are to be translated. */
export const kCollectTexts = `
  const kAttributes = ['aria-label', 'aria-valuetext', 'aria-roledescription', 'title', 'placeholder', 'alt']
  const isOurs = (element) => element && !element.closest('[translate=no], script, style, noscript')
  const collect = (root, texts) => {
    if (!root.isConnected) return
    const walker = document.createTreeWalker(root, NodeFilter.SHOW_ELEMENT | NodeFilter.SHOW_TEXT)
    for (let node = root; node; node = walker.nextNode())
      if (node instanceof Text) isOurs(node.parentElement) && texts.add(node.data)
      else if (node instanceof Element && isOurs(node))
        for (const name of kAttributes) if (node.getAttribute(name)) texts.add(node.getAttribute(name))
  }
  globalThis.textsNow = () => {
    const texts = new Set()
    collect(document.documentElement, texts)
    return [...texts]
  }
  const ever = new Set()
  globalThis.textsEver = () => [...ever]
  new MutationObserver((records) => {
    for (const { type, target, addedNodes } of records)
      for (const root of type === 'childList' ? addedNodes : [target]) collect(root, ever)
  }).observe(document, { subtree: true, childList: true, characterData: true, attributeFilter: kAttributes })`;

/** The texts that the page shows, or has ever shown since it was opened; it has to have `kCollectTexts`. */
export const textsOf = (page: Page, when: 'now' | 'ever'): Promise<string[]> =>
  page.evaluate(when === 'now' ? 'textsNow()' : 'textsEver()');
