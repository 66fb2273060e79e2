// What the package does unless it is told otherwise.
import { init, transfer } from 'cagecast';
import type { MethodModule } from '../run-method.js';

export const prepare = init;
export const zones: MethodModule['zones'] = ({ cage, target }) => transfer(cage, target).zones;
