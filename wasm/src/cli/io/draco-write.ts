import { type Accessor, Document, type GLTF, Logger, NodeIO, type TypedArray } from '@gltf-transform/core';
import { KHRDracoMeshCompression } from '@gltf-transform/extensions';
import { dracoOf } from '../../gltf/checks/check-geometry.js';
import type { GlbWriter } from '../../gltf/glb-writer.js';
import type { GltfFile } from '../../gltf/open-gltf.js';
import { dracoExtension, unmarkDraco } from '../../gltf/output/draco-marks.js';
import { createDracoEncoder } from './draco.js';

const silent = new Logger(Logger.Verbosity.SILENT);

/**
 * Compresses those primitives again that were compressed by Draco and have been added to. Positions get 14 bits, normals 10, as is
 * usual: what was rounded so before stays as it is. Integers, such as the UVs and zones of a transfer, keep their values, and so do
 * attributes with names of an application's own; UVs of a transfer that are not within 0..1 get 16 bits. Vertices and triangles may change
 * their order, except in primitives with morph targets.
 */
export async function packDraco(writer: GlbWriter, file: GltfFile): Promise<void> {
  const all = (writer.json.meshes ?? []).flatMap((mesh) => mesh.primitives);
  const primitives = all.filter(
    (primitive) => dracoOf(primitive) && Object.values(primitive.attributes).some((a) => writer.stored(a)),
  );
  if (primitives.length === 0) return;
  const io = new NodeIO()
    .setLogger(silent)
    .registerExtensions([KHRDracoMeshCompression])
    .registerDependencies({ 'draco3d.encoder': await createDracoEncoder() });
  for (const primitive of primitives) {
    const { json, resources } = await io.writeJSON(documentOf(writer, file, primitive));
    const packed = json.meshes![0]!.primitives[0]!;
    const stream = dracoOf(packed);
    if (stream === undefined) {
      // Draco has no form for it, such as for triangles without any area.
      writePlain(writer, file, primitive);
      continue;
    }
    const { bufferView, attributes } = stream;
    const { buffer, byteOffset = 0, byteLength } = json.bufferViews![bufferView]!;
    const bytes = resources[json.buffers![buffer]!.uri!]!.slice(byteOffset, byteOffset + byteLength);
    primitive.extensions = {
      ...primitive.extensions,
      [dracoExtension]: { bufferView: writer.addView(bytes), attributes },
    };
    for (const [semantic, accessor] of Object.entries(packed.attributes)) {
      const { name, extras } = writer.json.accessors![primitive.attributes[semantic]!]!;
      const own = { ...json.accessors![accessor]!, ...(name !== undefined && { name }), ...(extras && { extras }) };
      primitive.attributes[semantic] = writer.addAccessor(withoutView(own));
    }
    primitive.indices = writer.addAccessor(withoutView(json.accessors![packed.indices!]!));
  }
}

/** Stores what only a Draco stream holds. */
function writePlain(writer: GlbWriter, file: GltfFile, primitive: GLTF.IMeshPrimitive): void {
  const inStream = (accessor: number) =>
    !writer.stored(accessor) && writer.json.accessors![accessor]!.bufferView === undefined;
  for (const [semantic, accessor] of Object.entries(primitive.attributes)) {
    if (!inStream(accessor)) continue;
    const { normalized, min, max } = writer.json.accessors![accessor]!;
    const more = { ...(normalized && { normalized }), ...(min && { min }), ...(max && { max }) };
    const decoded = file.accessors[accessor]!;
    primitive.attributes[semantic] = writer.addAttribute(decoded.getArray()!, decoded.getElementSize(), more);
  }
  if (primitive.indices !== undefined && inStream(primitive.indices)) {
    const count = writer.json.accessors![primitive.attributes['POSITION']!]!.count;
    primitive.indices = writer.addIndices(Uint32Array.from(file.accessors[primitive.indices]!.getArray()!), count);
  }
  unmarkDraco([primitive]);
}

/** In a compressed primitive, the stream has the bytes. */
function withoutView({ bufferView: _, byteOffset: __, ...accessor }: GLTF.IAccessor): GLTF.IAccessor {
  return accessor;
}

/** A document of one primitive. */
function documentOf(writer: GlbWriter, file: GltfFile, primitive: GLTF.IMeshPrimitive): Document {
  const document = new Document().setLogger(silent);
  const values = (accessor: number): TypedArray =>
    writer.stored(accessor)?.values ?? file.accessors[accessor]!.getArray()!;
  const compression = document.createExtension(KHRDracoMeshCompression).setRequired(true);
  // These may be numbers of things. With 0 bits, they are not rounded.
  const isOwn = ([semantic, accessor]: [string, number]) =>
    semantic.startsWith('_') && values(accessor) instanceof Float32Array;
  const areFarUvs = ([semantic, accessor]: [string, number]) =>
    semantic.startsWith('TEXCOORD_') && writer.stored(accessor)?.values instanceof Float32Array;
  const attributes = Object.entries(primitive.attributes);
  compression.setEncoderOptions({
    quantizationBits: {
      ...(attributes.some(isOwn) && { GENERIC: 0 }),
      ...(attributes.some(areFarUvs) && { TEX_COORD: 16 }),
    },
  });
  const buffer = document.createBuffer();
  const accessorOf = (accessor: number): Accessor => {
    const { type, normalized = false } = writer.json.accessors![accessor]!;
    const own = values(accessor).slice() as TypedArray;
    return document.createAccessor().setType(type).setNormalized(normalized).setArray(own).setBuffer(buffer);
  };
  const made = document.createPrimitive();
  for (const [semantic, accessor] of Object.entries(primitive.attributes))
    made.setAttribute(semantic, accessorOf(accessor));
  made.setIndices(accessorOf(primitive.indices!));
  // With a morph target, vertices stay in their order.
  if (primitive.targets) made.addTarget(document.createPrimitiveTarget());
  document.createMesh().addPrimitive(made);
  return document;
}
