// Checks that workflows and examples name what they take from elsewhere by its content: actions and sources by a commit, images by a
// digest. A tag or a branch is whatever its owner makes of it tomorrow.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';

/** Images that are built from this repository. */
const kOwn = ['catalogue'];
const hasDigest = (name) => /@sha256:[0-9a-f]{64}$/.test(name);

/** What a line may take from elsewhere, and whether it says so by content. */
const kRules = [
  {
    line: /\buses:\s*["']?([^\s"'#,}]+)/,
    isPinned: (name) => name.startsWith('./') || /@[0-9a-f]{40}$/.test(name),
    want: 'a commit of 40 digits, with the version behind it as a comment',
  },
  {
    line: /\b(?:image|container):\s*["']?([^\s"'#{,}]+)/,
    isPinned: (name) => hasDigest(name) || kOwn.includes(name),
    want: 'an image with its digest, NAME:TAG@sha256:…',
  },
  {
    line: /^\s*FROM\s+(?:--\S+\s+)*(\S+)/,
    isPinned: (name) => hasDigest(name) || name === 'scratch',
    want: 'an image with its digest, NAME:TAG@sha256:…',
  },
  {
    line: /\b(git clone\b.*)/,
    isPinned: () => false,
    want: 'git fetch of one commit, as .github/workflows/ci.yml has it',
  },
];

/**
 * @param {string} root  The repository, or a tree like it.
 * @param {string[]} files  Paths from there.
 * @return {string[]}  What is wrong.
 */
export function checkPins(root, files) {
  const problems = [];
  for (const path of files.filter((file) => /^(\.github|examples)\/.*(\.(ya?ml|sh)|Dockerfile[^/]*)$/.test(file))) {
    const lines = readFileSync(join(root, path), 'utf8').split('\n');
    for (const [i, text] of lines.entries()) {
      if (text.trimStart().startsWith('#')) continue;
      for (const { line, isPinned, want } of kRules) {
        const name = line.exec(text)?.[1];
        if (name && !isPinned(name)) problems.push(`${path}:${i + 1}: ${name} is not pinned; write ${want}`);
      }
    }
  }
  return problems;
}
