import { freeName, zip } from '../platform/zip';
import { bareGroupsOf, choicesOf } from '../state/choices';
import type { Session } from '../state/session';
import { type Avatar, nameOf } from '../state/wardrobe/avatar';
import { endingOf } from './ending';
import type { PaintInto } from './export-messages';

/**
 * Writes the avatars as GLBs with the paint, all in one ZIP file.
 * @param avatars  Each is painted.
 * @param png  The composite of the layers, for those that take it.
 * @param report Called with how many are done.
 * @returns The file, and what went wrong with some of them.
 * @throws Error if nothing could be written.
 */
export async function exportAll(
  avatars: readonly Avatar[],
  session: Session,
  active: Avatar,
  png: Blob,
  report: (done: number) => void,
): Promise<{ file: Blob; count: number; troubles: string[] }> {
  const { rules, choices } = session;
  const { exportGlb } = await import('./export-glb');
  const files: { name: string; blob: Blob }[] = [];
  const troubles: string[] = [];
  const into = document.querySelector<HTMLInputElement>('#paint-into :checked')!.value as PaintInto;
  for (const [done, avatar] of avatars.entries()) {
    report(done);
    try {
      const { shown } = session;
      const { model, projection } = avatar === active ? { ...shown, model: shown?.target } : (avatar.standing ?? {});
      const target = { name: avatar.name, files: avatar.files, ...(model && { mesh: model.mesh }) };
      const bare = bareGroupsOf(model && { target: model, cage: avatar.cage! });
      const scene = {
        target,
        cage: avatar.cage!,
        rules,
        projection,
        choices: avatar === active ? choices : choicesOf(avatar.locks, bare, projection, session.bareOf(avatar.files)),
      };
      const { glb } = await exportGlb(scene, avatar.takesPaint ? png : avatar.own!.paint.file!, into);
      const { name } = avatar.files[0]!;
      files.push({ name: freeName(avatar.sample?.name ?? nameOf(name), endingOf(name), files), blob: glb });
    } catch (error) {
      troubles.push((error as Error).message);
    }
  }
  if (files.length === 0) throw new Error(troubles[0] ?? 'No avatar takes this paint.');
  return { file: await zip(files), count: files.length, troubles };
}
