import assert from 'node:assert/strict';
import { test } from 'node:test';
import { NodeIO } from '@gltf-transform/core';
import { avatarExtensions } from '../../../web/src/export/avatar-extensions';
import { GlbMaker, tetrahedron, unpackGlb } from '../../support/glb';

// Signatures suffice: nothing decodes them.
const picture = (name: string): Uint8Array => new Uint8Array([0x89, 0x50, 0x4e, 0x47, name.charCodeAt(0)]);

/** A copy that may be read without types. */
const copy = (data: unknown) => JSON.parse(JSON.stringify(data));

/** A file whose first node, mesh, material and image are not used, so that they can be left out. */
function avatar() {
  const maker = new GlbMaker();
  const own = maker.json;
  own.images = ['left out', 'thumbnail', 'skin'].map((name) => ({
    name,
    mimeType: 'image/png',
    bufferView: maker.view(picture(name)),
  }));
  own.textures = [{ source: 2 }, { source: 1 }];
  own.materials = [
    { name: 'left out' },
    {
      name: 'skin',
      pbrMetallicRoughness: { baseColorTexture: { index: 0 } },
      extensions: { VRMC_materials_mtoon: { specVersion: '1.0', shadeMultiplyTexture: { index: 0, texCoord: 0 } } },
    },
  ];
  maker.mesh(tetrahedron(1));
  const mesh = maker.mesh(tetrahedron(2), { material: 1 });
  maker.node({ name: 'left out' });
  maker.node({
    name: 'hips',
    extensions: { VRMC_node_constraint: { constraint: { roll: { source: 2, weight: 1 } } } },
  });
  maker.node({ name: 'face', mesh });
  own.extensions = {
    VRM: {
      meta: { title: 'Ünïcode', texture: 1 },
      humanoid: { humanBones: [{ bone: 'hips', node: 1 }] },
      firstPerson: { firstPersonBone: 1, meshAnnotations: [{ mesh: 1, firstPersonFlag: 'Auto' }] },
      blendShapeMaster: { blendShapeGroups: [{ name: 'A', binds: [{ mesh: 1, index: 0, weight: 100 }] }] },
      secondaryAnimation: { boneGroups: [{ center: -1, bones: [1, 2], colliderGroups: [0] }] },
      materialProperties: [{ name: 'skin', floatProperties: { _Cutoff: 2 }, textureProperties: { _MainTex: 0 } }],
    },
    VRMC_vrm: {
      meta: { thumbnailImage: 1 },
      humanoid: { humanBones: { hips: { node: 1 } } },
      expressions: { preset: { happy: { materialColorBinds: [{ material: 1, targetValue: [1, 2, 0, 1] }] } } },
    },
  };
  own.extensionsUsed = ['VRM', 'VRMC_vrm', 'VRMC_materials_mtoon', 'VRMC_node_constraint'];
  return { own, bytes: maker.finish() };
}

test('what a VRM says of its avatar is kept, with the indices that the written file has', async () => {
  const { own, bytes } = avatar();
  const io = new NodeIO().registerExtensions(avatarExtensions);
  const document = await io.readBinary(new Uint8Array(bytes));
  const same = unpackGlb(await io.writeBinary(document)).json;
  const textureOf = (json: typeof same, index: number): string => json.images![json.textures![index]!.source!]!.name!;
  // Textures may be listed in another order.
  const named = (json: typeof same): object => {
    const extensions = copy(json.extensions);
    extensions.VRM.meta.texture = textureOf(json, extensions.VRM.meta.texture);
    const [{ textureProperties }] = extensions.VRM.materialProperties;
    textureProperties._MainTex = textureOf(json, textureProperties._MainTex);
    return extensions;
  };
  assert.deepEqual(named(same), named(own));
  assert.deepEqual(same.extensionsUsed, own.extensionsUsed!.toSorted());

  const root = document.getRoot();
  for (const list of [root.listNodes(), root.listMeshes(), root.listMaterials(), root.listTextures()])
    list[0]!.dispose();
  const { json } = unpackGlb(await io.writeBinary(document));
  const { VRM, VRMC_vrm } = copy(json.extensions);
  assert.equal(textureOf(json, VRM.meta.texture), 'thumbnail');
  assert.equal(textureOf(json, VRM.materialProperties[0].textureProperties._MainTex), 'skin');
  assert.equal(VRM.materialProperties[0].floatProperties._Cutoff, 2);
  assert.equal(VRM.humanoid.humanBones[0].node, 0);
  assert.equal(VRM.firstPerson.firstPersonBone, 0);
  assert.equal(VRM.firstPerson.meshAnnotations[0].mesh, 0);
  assert.deepEqual(VRM.blendShapeMaster.blendShapeGroups[0].binds, [{ mesh: 0, index: 0, weight: 100 }]);
  assert.deepEqual(VRM.secondaryAnimation.boneGroups, [{ center: -1, bones: [0, 1], colliderGroups: [0] }]);
  assert.equal(json.images![VRMC_vrm.meta.thumbnailImage]!.name, 'thumbnail');
  assert.equal(VRMC_vrm.humanoid.humanBones.hips.node, 0);
  assert.deepEqual(VRMC_vrm.expressions.preset.happy.materialColorBinds, [{ material: 0, targetValue: [1, 2, 0, 1] }]);
  const [{ extensions: material }] = copy(json.materials);
  assert.equal(textureOf(json, material.VRMC_materials_mtoon.shadeMultiplyTexture.index), 'skin');
  assert.deepEqual(json.nodes![0]!.extensions, {
    VRMC_node_constraint: { constraint: { roll: { source: 1, weight: 1 } } },
  });
});
