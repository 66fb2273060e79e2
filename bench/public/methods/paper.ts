// The method as it was published.
import { init, transfer } from 'cagecast';
import type { MethodModule } from '../run-method.js';

export const prepare = init;
export const zones: MethodModule['zones'] = ({ cage, target }) => transfer(cage, target, { preset: 'paper' }).zones;
