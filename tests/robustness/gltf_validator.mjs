// SPDX-License-Identifier: Apache-2.0
// node gltf_validator.mjs SCENE.gltf: the Khronos validator (npm package gltf-validator) must find no error and no
// warning.
//
// The module is searched in the folder IBR_GLTF_VALIDATOR (the package, or the folder with node_modules), then in
// node's search path, NODE_PATH included. Exit code 77 if the module is not installed.
import fs from 'node:fs';
import { createRequire } from 'node:module';
import path from 'node:path';

function findValidator() {
  const require = createRequire(import.meta.url);
  const named = process.env.IBR_GLTF_VALIDATOR;
  const places = named ? [named, path.join(named, 'node_modules', 'gltf-validator')] : [];
  for (const place of [...places.map((p) => path.resolve(p)), 'gltf-validator']) {
    try {
      return require(place);
    } catch (error) {
      if (error.code !== 'MODULE_NOT_FOUND') throw error;
    }
  }
  console.log('skipped: the npm package gltf-validator is not installed (IBR_GLTF_VALIDATOR, NODE_PATH)');
  process.exit(77);
}

const validator = findValidator();
const file = path.resolve(process.argv[2]);
const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), {
  uri: path.basename(file),
  maxIssues: 0,
  externalResourceFunction: async (uri) =>
    new Uint8Array(fs.readFileSync(path.join(path.dirname(file), decodeURIComponent(uri)))),
});
const { numErrors, numWarnings, numInfos, numHints, messages } = report.issues;
const NAMES = ['error', 'warning', 'information', 'hint'];
const bad = messages.filter((m) => m.severity <= 1);
const codes = {};
for (const m of messages) codes[`${NAMES[m.severity]} ${m.code}`] = (codes[`${NAMES[m.severity]} ${m.code}`] ?? 0) + 1;
for (const m of bad) console.log(`${NAMES[m.severity]} ${m.code} ${m.pointer ?? ''}: ${m.message}`);
console.log(`${validator.version()}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} informations, ` +
            `${numHints} hints`, codes);
process.exit(bad.length > 0 ? 1 : 0);
