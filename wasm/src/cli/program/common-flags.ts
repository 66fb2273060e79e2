import type { Command } from 'commander';
import { addConfigFlags, type ConfigFlags } from '../config/config-flags.js';
import { addRuleFlags, type RuleFlags } from '../options.js';
import { addCageAreaFlags, type CageFlags } from '../paint/paint-flags.js';
import { addPrintFlags, type PrintFlags } from '../print.js';
import { addReadFlags, type ReadFlags } from '../read-flags.js';

/** The flags of the commands that transfer to one target. */
export interface CommonFlags extends RuleFlags, CageFlags, ConfigFlags, ReadFlags, PrintFlags {
  cage: string;
}

/** Adds TARGET, and the flags of the commands that transfer to it. */
export function addCommonFlags(command: Command): Command {
  command
    .argument('<TARGET>', 'GLB, glTF or VRM that receives the texture')
    .requiredOption('--cage <CAGE>', 'GLB or glTF that the texture was drawn for; it must have UVs; auto makes one')
    .allowExcessArguments(false);
  for (const add of [addCageAreaFlags, addRuleFlags, addConfigFlags, addReadFlags, addPrintFlags]) add(command);
  return command;
}
