/** The command line does not make sense: the exit code is 2. */
export class Misuse extends Error {}
