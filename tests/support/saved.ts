import assert from 'node:assert/strict';
import { createRequire } from 'node:module';
import { buffer } from 'node:stream/consumers';
import { type Document, NodeIO, type Primitive } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import type { Page } from 'playwright-core';

/** The package has no types. */
const { validateBytes } = createRequire(import.meta.url)('gltf-validator') as {
  validateBytes(bytes: Uint8Array): Promise<{ issues: { numErrors: number; messages: unknown[] } }>;
};

/** The file that a button saves. @param key  Presses it by this key, as the mouse may be in use. */
export async function saved(page: Page, button: string, key?: string): Promise<{ name: string; bytes: Buffer }> {
  const place = page.getByTestId(button);
  const [file] = await Promise.all([page.waitForEvent('download'), key ? place.press(key) : place.click()]);
  return { name: file.suggestedFilename(), bytes: await buffer(await file.createReadStream()) };
}

/** Reads a model and asserts that it is valid glTF. */
export async function validModel(bytes: Uint8Array): Promise<Document> {
  const { issues } = await validateBytes(new Uint8Array(bytes));
  assert.equal(issues.numErrors, 0, JSON.stringify(issues.messages.slice(0, 3)));
  return new NodeIO().registerExtensions(ALL_EXTENSIONS).readBinary(new Uint8Array(bytes));
}

export const primitivesOf = (document: Document): Primitive[] =>
  document
    .getRoot()
    .listMeshes()
    .flatMap((mesh) => mesh.listPrimitives());
