import { classify } from 'cagecast';
import { bareGroupsOf, choicesOf } from '../choices';
import { isUpToDate, moveChoices, projectBy, withoutParts } from '../left-out';
import { landmarksOf, type Model } from '../model';
import type { Paint } from '../paint';
import { haveSameUvs } from '../same-uvs';
import { kMaxInspected } from '../verdict/verdict';
import type { Avatar } from './avatar';
import type { AvatarList } from './avatar-list';
import type { Surroundings } from './surroundings';

/** Transfers the paint to the avatars that stand beside the stage. */
export class AvatarTransfers {
  readonly #around: Surroundings;
  readonly #list: AvatarList;
  /** Cages for which nothing can be drawn. */
  readonly #undrawable = new WeakSet<Model>();
  readonly #onTransfer: () => void;

  /** @param onTransfer Called when an avatar begins to stand beside the stage. */
  constructor(around: Surroundings, list: AvatarList, onTransfer: () => void) {
    this.#around = around;
    this.#list = list;
    this.#onTransfer = onTransfer;
  }

  /** Transfers the paint to an avatar, lets it stand beside the stage, and inspects it. */
  async transfer(avatar: Avatar, model: Model): Promise<void> {
    const { session, loader, transferer } = this.#around;
    if (!this.#list.has(avatar)) return loader.dispose(model);
    const { cage } = avatar;
    this.#list.update(avatar, { doing: 'Being painted' });
    const projection =
      cage && (await projectBy(transferer, { cage, target: model }, session.rules, () => avatar.locks));
    if (!this.#list.has(avatar)) return loader.dispose(model);
    const standing = this.#around.view.stand(model, projection);
    avatar.standing = standing;
    this.dress(avatar);
    this.update(avatar);
    this.#onTransfer();
    await this.#inspect(avatar);
  }

  /** Shows the paint of the stage on an avatar whose cage takes it; on another one the base, once it is drawn for that cage. */
  dress(avatar: Avatar): void {
    const { cage, own } = avatar;
    avatar.takesPaint = cage !== undefined && haveSameUvs(cage, this.#around.session.shown!.cage);
    if (own && own.cage !== cage) this.#setOwn(avatar, undefined);
    const drawing = this.#drawingOf(avatar);
    if (drawing?.name !== avatar.own?.paint.drawn) {
      if (!drawing) this.#setOwn(avatar, undefined);
      else this.#list.queue(avatar, () => this.#draw(avatar));
    }
    avatar.standing?.setPaint(avatar.takesPaint ? 'stage' : avatar.own?.paint.texture);
  }

  /** What is to be drawn for an avatar. */
  #drawingOf({ cage, takesPaint }: Avatar): ReturnType<Surroundings['drawing']> {
    return cage && !takesPaint && !this.#undrawable.has(cage) ? this.#around.drawing() : undefined;
  }

  async #draw(avatar: Avatar): Promise<void> {
    const { cage } = avatar;
    const drawing = this.#drawingOf(avatar);
    if (!drawing || drawing.name === avatar.own?.paint.drawn) return;
    this.#list.update(avatar, { doing: 'Being painted' });
    const paint = await drawing.draw(cage!).catch((error: unknown) => {
      this.#undrawable.add(cage!);
      throw error;
    });
    if (cage !== avatar.cage || !this.#list.has(avatar)) return dispose(paint);
    this.#setOwn(avatar, { paint, cage: cage! });
    this.dress(avatar);
    this.#onTransfer();
  }

  #setOwn(avatar: Avatar, own: Avatar['own']): void {
    if (avatar.own) dispose(avatar.own.paint);
    avatar.own = own;
  }

  async #inspect(avatar: Avatar): Promise<void> {
    const { standing, cage, locks } = avatar;
    if (!standing || !cage || standing.model.mesh.indices.length + cage.mesh.indices.length > 3 * kMaxInspected) return;
    const { preset, threshold, weldTolerance } = this.#around.session.rules;
    const choices = choicesOf(locks, bareGroupsOf({ target: standing.model, cage }), undefined);
    const landmarks = landmarksOf(cage);
    const options = { preset, threshold, weldTolerance, ...choices, landmarks };
    const target = standing.projection ? withoutParts(standing.model, standing.projection) : standing.model;
    const { verdict } = await this.#around.transferer.ask('inspect', cage, target, options);
    this.#list.update(avatar, { verdict });
  }

  /** Makes what stands beside the stage follow the rules: the threshold at once, others by another transfer. */
  update(avatar: Avatar): void {
    const isOutdated = (): boolean => {
      const { projection } = avatar.standing ?? {};
      return projection !== undefined && !isUpToDate(projection, this.#around.session.rules, avatar.locks);
    };
    this.#classify(avatar);
    if (!isOutdated()) return;
    this.#list.queue(avatar, async () => {
      const { cage, standing } = avatar;
      if (!cage || !standing || avatar === this.#list.active || !isOutdated()) return;
      const { session, transferer } = this.#around;
      const scene = { cage, target: standing.model };
      const { segments } = standing.projection!;
      const projection = await projectBy(transferer, scene, session.rules, (made) =>
        moveChoices(avatar.locks, segments, made.segments),
      );
      if (avatar.standing !== standing) return;
      avatar.locks = moveChoices(avatar.locks, segments, projection.segments);
      standing.setProjection(projection);
      this.update(avatar);
    });
  }

  #classify(avatar: Avatar): void {
    const { standing, cage, locks, files } = avatar;
    if (!standing?.projection) return;
    const { threshold } = this.#around.session.rules;
    const bare = cage ? bareGroupsOf({ target: standing.model, cage }) : [];
    const choices = choicesOf(locks, bare, standing.projection, this.#around.session.bareOf(files));
    const classification = classify(standing.projection, { threshold, ...choices });
    standing.classify(classification);
    this.#around.view.redraw();
  }

  /** Frees what stands beside the stage, and the paint that was drawn for it. */
  clear(avatar: Avatar): void {
    const { standing } = avatar;
    this.#setOwn(avatar, undefined);
    if (!standing) return;
    avatar.standing = undefined;
    standing.dispose();
    this.#around.loader.dispose(standing.model);
  }
}

function dispose({ texture, picture }: Paint): void {
  texture.dispose();
  URL.revokeObjectURL(picture);
}
