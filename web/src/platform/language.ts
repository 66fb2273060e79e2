import { element } from './page';

/** The languages of the page, and their dictionaries; English is the one that it is written in. */
const kDictionaries: Record<string, () => string> = {
  de: () => new URL('../words/de.json', import.meta.url).href,
  ja: () => new URL('../words/ja.json', import.meta.url).href,
};
const kKey = 'cagecast-language';
const kParameter = 'lang';

const isOffered = (language: string | null): language is string =>
  language === 'en' || Object.hasOwn(kDictionaries, language ?? '');

/** The language in the address, else the last choice, else the browser's. */
function wanted(): string {
  const asked = new URLSearchParams(location.search).get(kParameter);
  return [asked, chosen(), ...navigator.languages.map((tag) => tag.slice(0, 2))].find(isOffered) ?? 'en';
}

function chosen(): string | null {
  try {
    return localStorage.getItem(kKey);
  } catch {
    return null; // Browsers may forbid to store anything.
  }
}

let latest = 'en';

/** Shows the page in a language; as it was if its dictionary cannot be had. */
async function show(language: string): Promise<void> {
  const before = latest;
  if (language === before) return;
  latest = language;
  try {
    const address = kDictionaries[language]?.();
    // English needs neither.
    const [{ showWords }, entries] = await Promise.all([
      import('./words'),
      address && fetch(address).then((response) => response.json()),
    ]);
    if (language !== latest) return;
    showWords(entries || undefined);
    document.documentElement.lang = language;
  } catch {
    latest = before;
  }
}

/** Shows the page in the language that is wanted, and connects the choice of it. */
export function setUpLanguage(): void {
  const select = element('language', HTMLSelectElement);
  const begin = wanted();
  select.value = begin;
  select.addEventListener('change', () => {
    void show(select.value);
    // The choice counts from now on, not what a link asked for.
    const address = new URL(location.href);
    address.searchParams.delete(kParameter);
    history.replaceState(history.state, '', address);
    try {
      localStorage.setItem(kKey, select.value);
    } catch {
      // The next visit begins with the browser's language.
    }
  });
  void show(begin);
}
