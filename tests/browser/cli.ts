import { execFile } from 'node:child_process'
import { mkdtemp, readFile, rm } from 'node:fs/promises'
import { tmpdir } from 'node:os'
import path from 'node:path'
import { promisify } from 'node:util'
import { inRepository, type Counts } from './site'

/** The counts that `cagecast transfer` reports for two files. */
export async function reportedCounts(target: string, cage: string, threshold = 0.5): Promise<Counts> {
  const folder = await mkdtemp(path.join(tmpdir(), 'cagecast-report-'))
  try {
    const report = path.join(folder, 'report.json')
    const args = ['transfer', target, '--cage', cage, '--threshold', String(threshold), '--report', report]
    await promisify(execFile)(process.execPath, [inRepository('dist/cli.js'), ...args])
    const { counts } = JSON.parse(await readFile(report, 'utf8'))
    const { cosmetic, occluded, uncovered, culled } = counts
    return { cosmetic, occluded, uncovered, culled }
  } finally {
    await rm(folder, { recursive: true, force: true })
  }
}
