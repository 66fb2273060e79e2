import { readFile } from 'node:fs/promises';
import { transform } from 'esbuild';
import type { Plugin } from 'vite';

const kFile = /\/basis_transcoder(-[\w-]+)?\.js$/;

// Calls into C++ and out of it, with types that are known when the module starts.
const kCallIn = `var invokerFn=function(...given){
  if(given.length!==argCount-2)throwBindingError(humanName+" takes "+(argCount-2)+" arguments, not "+given.length);
  var destructors=needsDestructorStack?[]:null;
  var types=argTypes.slice(isClassMethodFunc?1:2),values=isClassMethodFunc?[this,...given]:given;
  var wired=types.map((type,i)=>type.toWireType(destructors,values[i]));
  var result=cppInvokerFunc(cppTargetFunc,...wired);
  if(destructors)runDestructors(destructors);else types.forEach((type,i)=>type.destructorFunction?.(wired[i]));
  if(returns)return argTypes[0].fromWireType(result)};`;
const kCallOut = `var invokerFunction=(obj,func,destructorsRef,at)=>{
  var given=types.map(type=>{var value=type.readValueFromPointer(at);at+=type.argPackAdvance;return value});
  var result=kind===1?new func(...given):func.call(obj,...given);
  return retType.isVoid?undefined:emval_returnValue(retType,destructorsRef,result)};`;

/** Where the transcoder creates functions from text: how each place begins, what follows it, and its replacement. */
const kPlaces = [
  ['let[args,invokerFnBody]=', 'return createNamedFunction(humanName,', kCallIn],
  ['var functionBody=', 'var functionName=', kCallOut],
] as const;

/** The transcoder without functions from text. @throws Error if its code is not as expected. */
function withoutEval(code: string): string {
  for (const [first, next, instead] of kPlaces) {
    const [from, to] = [code.indexOf(first), code.indexOf(next, code.indexOf(first))];
    if (from < 0 || to < 0)
      throw new Error(`basis_transcoder.js has no “${first} … ${next}”; adapt web/basis.ts to the new version`);
    code = code.slice(0, from) + instead + code.slice(to);
  }
  if (code.includes('newFunc(Function'))
    throw new Error('basis_transcoder.js creates further functions from text; adapt web/basis.ts');
  return code;
}

const kNoZstd = '\0no-zstd';

/** Makes Basis' KTX2 transcoder work under the page's content security policy, which forbids `new Function`. */
export function basis(): Plugin {
  return {
    name: 'cagecast-basis',
    enforce: 'pre',
    configureServer(server) {
      server.middlewares.use(async (request, response, next) => {
        const { pathname, searchParams } = new URL(request.url ?? '/', 'http://localhost');
        // Vite answers requests for the URL only.
        if (!kFile.test(pathname) || searchParams.has('url')) return next();
        response.setHeader('Content-Type', 'text/javascript');
        response.end(
          withoutEval(
            await readFile(new URL(import.meta.resolve('three/addons/libs/basis/basis_transcoder.js')), 'utf8'),
          ),
        );
      });
    },
    // Zstandard is only needed for textures that glTF does not allow; leaving it out saves 17 KB gzipped.
    resolveId: (source) => (source.endsWith('/zstddec.module.js') ? kNoZstd : undefined),
    load: (id) => (id === kNoZstd ? 'export class ZSTDDecoder {}' : undefined),
    async generateBundle(_, bundle) {
      for (const file of Object.values(bundle)) {
        if (file.type === 'asset' && kFile.test(`/${file.fileName}`))
          file.source = (await transform(withoutEval(file.source.toString()), { minify: true })).code;
      }
    },
  };
}
