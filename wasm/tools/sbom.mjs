// The list of parts of the packed package (SBOM, CycloneDX 1.6): the package and what others wrote in it. What develops it is in package-lock.json.

import { createHash } from 'node:crypto';

/**
 * The same bytes for the same package: it has neither the time nor a random number.
 * @param {{name: string, version: string, license: string, homepage: string}} manifest  package.json
 * @param {import('./notices.mjs').Part[]} parts
 * @param {Buffer} packed  The file that npm packed.
 */
export function sbomOf({ name, version, license, homepage }, parts, packed) {
  const hash = (alg) => ({ alg, content: createHash(alg.replace('-', '')).update(packed).digest('hex') });
  const own = componentOf({ name, version, license, url: homepage, purl: `pkg:npm/${name}@${version}` });
  const components = parts.map(componentOf);
  return {
    $schema: 'http://cyclonedx.org/schema/bom-1.6.schema.json',
    bomFormat: 'CycloneDX',
    specVersion: '1.6',
    version: 1,
    metadata: { component: { ...own, hashes: [hash('SHA-256'), hash('SHA-512')] } },
    components,
    dependencies: [{ ref: own['bom-ref'], dependsOn: components.map((part) => part['bom-ref']) }],
  };
}

function componentOf({ name, version, license, url, purl, where }) {
  return {
    type: 'library',
    'bom-ref': purl,
    name,
    version,
    ...(where && { description: `in ${where}` }),
    licenses: [license.includes(' ') ? { expression: license } : { license: { id: license } }],
    purl,
    ...(url && { externalReferences: [{ type: 'website', url }] }),
  };
}
