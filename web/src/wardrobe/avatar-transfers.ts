import { classify } from 'cagecast';
import { Group, type Texture } from 'three';
import { paintableShare } from '../panels/stage-verdict';
import { disposeModel, type Model } from '../scene/load-model';
import { haveSameUvs } from '../scene/same-uvs';
import { choicesOf, type Session } from '../scene/session';
import { TransferClient } from '../scene/transfer-client';
import { Overlay } from '../view/overlay/overlay';
import type { Viewer } from '../view/viewer';
import type { Avatar } from './avatar';
import type { AvatarList } from './avatar-list';
import type { Surroundings } from './set-up-wardrobe';
import { measure } from './side-by-side';

const kMaxInspected = 60_000; // triangles; the time grows with their number

/** Transfers the paint to the avatars that stand beside the stage. */
export class AvatarTransfers {
  readonly #session: Session;
  readonly #viewer: Viewer;
  readonly #paint: Texture;
  readonly #list: AvatarList;
  readonly #onTransfer: (avatar: Avatar) => void;
  readonly #client = new TransferClient();

  /** @param onTransfer Called when an avatar begins to stand beside the stage. */
  constructor({ session, viewer, paint }: Surroundings, list: AvatarList, onTransfer: (avatar: Avatar) => void) {
    this.#session = session;
    this.#viewer = viewer;
    this.#paint = paint;
    this.#list = list;
    this.#onTransfer = onTransfer;
  }

  /** Transfers the paint to an avatar, lets it stand beside the stage, and inspects it. */
  async transfer(avatar: Avatar, model: Model): Promise<void> {
    if (!this.#list.has(avatar)) return disposeModel(model);
    const { cage } = avatar;
    const { preset } = this.#session.rules;
    this.#list.tell(avatar, { doing: 'Painting' });
    const projection = cage && (await this.#client.ask('project', cage, model, { preset }));
    if (!this.#list.has(avatar)) return disposeModel(model);
    const { scale, middle, wide, high } = measure(model);
    const [holder, inner] = [new Group(), new Group()];
    inner.position.copy(middle).negate();
    inner.add(model.scene);
    holder.add(inner);
    holder.scale.setScalar(scale);
    const overlay = projection && new Overlay(model.mesh, projection, this.#paint);
    avatar.takesPaint = cage !== undefined && haveSameUvs(cage, this.#session.shown!.cage);
    avatar.standing = { holder, overlay, model, projection, wide, high, takesPaint: avatar.takesPaint };
    this.update(avatar);
    this.#onTransfer(avatar);
    await this.#inspect(avatar);
  }

  async #inspect(avatar: Avatar): Promise<void> {
    const { standing, cage, locks } = avatar;
    if (!standing || !cage || standing.model.mesh.indices.length + cage.mesh.indices.length > 3 * kMaxInspected) return;
    const { preset, threshold } = this.#session.rules;
    const parts = standing.model.mesh.primitives.map(({ name, firstVertex, vertexCount }) => ({
      name,
      firstVertex,
      vertexCount,
    }));
    const options = { preset, threshold, locks: choicesOf(locks, undefined).locks, parts };
    const { verdict } = await this.#client.ask('inspect', cage, standing.model, options);
    this.#list.tell(avatar, { verdict });
  }

  /** Makes what stands beside the stage follow the rules: the threshold at once, another preset by another transfer. */
  update(avatar: Avatar): void {
    const isOutdated = (): boolean => {
      const { projection } = avatar.standing ?? {};
      return projection !== undefined && projection.preset !== this.#session.rules.preset;
    };
    this.#classify(avatar);
    if (!isOutdated()) return;
    this.#list.queue(avatar, async () => {
      const { cage, standing } = avatar;
      if (!cage || !standing || avatar === this.#list.active || !isOutdated()) return;
      const { preset } = this.#session.rules;
      const projection = await this.#client.ask('project', cage, standing.model, { preset });
      if (avatar.standing !== standing) return;
      standing.projection = projection;
      standing.overlay?.setProjection(projection);
      this.update(avatar);
    });
  }

  #classify(avatar: Avatar): void {
    const { standing, locks, files } = avatar;
    if (!standing?.projection) return;
    const { threshold } = this.#session.rules;
    const choices = choicesOf(locks, standing.projection, this.#session.bareOf(files));
    const classification = classify(standing.projection, { threshold, ...choices });
    standing.overlay?.classify(classification);
    avatar.paintable = paintableShare(classification.segmentStats);
    this.#viewer.redraw();
  }

  /** Frees what stands beside the stage. */
  clear(avatar: Avatar): void {
    const { standing } = avatar;
    if (!standing) return;
    avatar.standing = undefined;
    standing.holder.removeFromParent();
    standing.overlay?.dispose();
    disposeModel(standing.model);
  }
}
