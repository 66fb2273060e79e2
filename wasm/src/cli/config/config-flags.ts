import type { Command } from 'commander';
import { type RuleFlags, type Rules, rulesOf } from '../options.js';
import { type ReadFlags, readingOf } from '../read-flags.js';
import { Configuration, configName } from './config-file.js';
import type { Settings } from './settings.js';

/** The flags that say which configuration file is read, as commander parses them. */
export interface ConfigFlags {
  config?: string | false;
}

/** The settings of a transfer, from flags, configuration file and default values. */
export interface ResolvedSettings extends Required<Pick<Settings, 'borders' | 'compress'>> {
  rules: Rules;
}

/** Adds the flags that say which configuration file is read. */
export const addConfigFlags = (command: Command): Command =>
  command
    .option(
      '--config <FILE>',
      `settings for all files, and by their names; default: the nearest ${configName}, from TARGET upwards`,
    )
    .option('--no-config', `read no ${configName}`);

/**
 * Returns a function that finds the settings of a target: from the flags that were given, else the configuration file, else default values.
 * @param command  The one that parsed the flags.
 */
export function settingsResolver(
  command: Command,
  flags: RuleFlags & ReadFlags & ConfigFlags & Partial<Pick<ResolvedSettings, 'borders' | 'compress'>>,
): (target: string) => Promise<ResolvedSettings> {
  const files = new Configuration(flags.config, readingOf(flags));
  const own = rulesOf(flags);
  const { borders = 'triangle', compress = 'keep' } = flags;
  const isGiven = (name: string) => command.getOptionValueSource(name) === 'cli';
  return async (target) => {
    const found = await files.settingsFor(target);
    if (found === undefined) return { rules: own, borders, compress };
    const pick = <Value>(name: string, value: Value, other: Value | undefined) =>
      isGiven(name) ? value : (other ?? value);
    const { path, single, masks, maskFolder, ranks } = found;
    const [keep, exclude] = [pick('keep', own.keep, found.keep), pick('exclude', own.exclude, found.exclude)];
    return {
      rules: {
        preset: pick('preset', own.preset, found.preset),
        single: { ...single, ...own.single },
        keep,
        exclude,
        ranks: {
          keep: isGiven('keep') ? keep.map(() => 0) : ranks.keep,
          exclude: isGiven('exclude') ? exclude.map(() => 0) : ranks.exclude,
        },
        // Flags about masks replace all of those in the file.
        ...(own.masks
          ? { masks: own.masks }
          : masks && { masks, configMasks: ['never', 'always'], ...(maskFolder && { maskFolder }) }),
        config: path,
        // A file speaks of many models, and not each of them has every part.
        optional: [...(isGiven('keep') ? [] : keep), ...(isGiven('exclude') ? [] : exclude)],
      },
      borders: pick('borders', borders, found.borders),
      compress: pick('compress', compress, found.compress),
    };
  };
}
