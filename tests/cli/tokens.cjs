// Print the scopes of a deck: one JSON list [line, text, scope] for each token.  node tokens.cjs GRAMMAR DECK
const fs = require("fs");
const path = require("path");
const oniguruma = require("vscode-oniguruma");
const { Registry, INITIAL, parseRawGrammar } = require("vscode-textmate");

async function main(grammar, deck) {
  const wasm = path.join(path.dirname(require.resolve("vscode-oniguruma")), "onig.wasm");
  await oniguruma.loadWASM(fs.readFileSync(wasm).buffer);
  const registry = new Registry({
    onigLib: Promise.resolve({
      createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
      createOnigString: (text) => new oniguruma.OnigString(text),
    }),
    loadGrammar: async () => parseRawGrammar(fs.readFileSync(grammar, "utf8"), grammar),
  });
  const rules = await registry.loadGrammar("source.flexmb");
  let state = INITIAL;
  fs.readFileSync(deck, "latin1").split(/\r?\n/).forEach((line, number) => {
    const found = rules.tokenizeLine(line, state);
    state = found.ruleStack;
    for (const token of found.tokens) {
      const text = line.slice(token.startIndex, token.endIndex);
      if (text.trim()) console.log(JSON.stringify([number + 1, text, token.scopes[token.scopes.length - 1]]));
    }
  });
}

main(process.argv[2], process.argv[3]);
