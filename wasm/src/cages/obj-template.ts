import { CagecastError, show } from '../core/error.js';
import { readObj } from '../parts/obj.js';
import { readTemplate } from '../parts/template-extras.js';
import type { Template } from './types.js';

/**
 * Reads a cage in the text of a Wavefront OBJ file as a template. MediaPipe's canonical face gets its landmarks and holes; other cages
 * have none: add `landmarks` before a fit.
 * @param text  Positions in any unit, y up; UVs; polygons, of all its objects together.
 * @throws {CagecastError} `badTemplate` that names the line.
 *
 * @example
 * const { cage } = await fitCage(objTemplate(await readFile('canonical_face_model.obj', 'utf8')), model);
 */
export function objTemplate(text: string): Template {
  const wrong = (reason: string) =>
    new CagecastError('badTemplate', 'objTemplate', `text: ${reason}`, { argument: 'text' });
  if (typeof text !== 'string')
    throw new CagecastError('badArgument', 'objTemplate', `text is ${show(text)}, not a string`, { argument: 'text' });
  return readTemplate(readObj(text, wrong), [], wrong);
}
