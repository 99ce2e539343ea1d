/* Every word that the daemon and the web server can say has a text for people. */

import assert from 'node:assert/strict';
import { readdirSync, readFileSync } from 'node:fs';
import { test } from 'node:test';
import { load, quoted, read, ROOT } from './sources.mjs';

const words = await load('base/words.js');
const { EVENTS } = await load('base/words_log.js');
const { FAULTS } = await load('base/words_faults.js');
const policy = await load('base/words_policy.js');

const api = JSON.parse(read('enroll/web/api/openapi.json'));

function same(table, wanted, least) {
    assert.ok(wanted.length >= least, `only ${wanted.length} words were found`);
    assert.deepEqual(Object.keys(table).sort(), [...new Set(wanted)].sort());
}

test('hints: core/base/capture.c', () => {
    same(words.HINTS, quoted('core/base/capture.c', 'iso_capture_name', '};'), 31);
});

test('reasons: firmware/visit/decision.c', () => {
    same(words.REASONS, quoted('firmware/visit/decision.c', '"none"', '};'), 13);
});

test('states and causes of the door: firmware/door/door.c', () => {
    same(words.DOOR_STATES, quoted('firmware/door/door.c', 'iso_door_state_name', '};'), 7);
    same(words.DOOR_CAUSES, quoted('firmware/door/door.c', 'iso_door_event_name', '};'), 15);
});

test('words of the contract', () => {
    const contract = 'firmware/contract/contract.h';
    same(EVENTS, quoted('firmware/contract/log_events.h', '#define ISO_CONTRACT_EVENTS', '#endif'), 38);
    same(words.DOOR_ACTS, quoted(contract, '#define ISO_CONTRACT_DOOR_UNLOCKED', '/* Keys of the reply of TestAccess'), 3);
    same(words.MODES, quoted('firmware/contract/status_keys.h', '"mode" s', '"sensor" s').filter((word) => word !== 'mode'), 5);
    same(words.POSES, quoted(contract, '#define ISO_CONTRACT_POSE_FRONTAL', '/* The states of a step'), 5);
    same(words.STEP_STATES, quoted(contract, '#define ISO_CONTRACT_STEP_BEGUN', '/* The stream of Watch'), 4);
    const results = quoted(contract, '/* Result words after', '/* What the door did')
        .filter((word) => word !== 'retry-');
    same(words.RESULTS, [...results, 'stopped', 'left'], 13);
});

test('roles and findings of the API', () => {
    same(words.ROLES, api.components.schemas.Role.enum, 3);
    same(words.ROLE_HELP, api.components.schemas.Role.enum, 3);
    same(words.FINDINGS, api.components.schemas.Health.properties.checks.items.properties.state.enum, 4);
    same(words.VERDICTS, api.components.schemas.Visit.properties.verdict.enum, 2);
});

test('codes of problems of the API', () => {
    const said = new Set();
    for (const methods of Object.values(api.paths)) {
        for (const { responses } of Object.values(methods)) {
            for (const [status, { description }] of Object.entries(responses)) {
                if (Number(status) >= 400) {
                    for (const code of description.split(/[;:]/)[0].split(', ')) {
                        said.add(code);
                    }
                }
            }
        }
    }
    const general = [...api.info.description.matchAll(/\b[45]\d\d ([a-z-]+)/g)].map((match) => match[1]);
    const missing = [...said, ...general].filter((code) => /^[a-z]+(-[a-z]+)*$/.test(code) && !(code in FAULTS));
    assert.ok(said.size >= 20 && general.length >= 6, `${said.size} and ${general.length} codes were found`);
    assert.deepEqual(missing, []);
});

test('hints are those of the screen for visitors', () => {
    const source = read('enroll/screen/scene/words.c');
    const rows = [...source.matchAll(/\{"([a-z-]+)", N_\("([^"]*)"\), NULL, /g)];
    assert.ok(rows.length >= 28);
    for (const [, word, text] of rows) {
        assert.equal(words.HINTS[word], text, word);
    }
});

test('what is wanted besides is said as on the screen for visitors', () => {
    const source = read('enroll/screen/scene/words.c');
    const table = source.slice(source.indexOf('wanted[] = {'), source.indexOf('enum {'));
    const rows = [...table.matchAll(/\{"([a-z]+)", N_\("([^"]*)"\), N_\("([^"]*)"\)/g)];
    assert.deepEqual(Object.keys(words.WANTED), rows.map(([, word]) => word));
    assert.deepEqual(Object.keys(words.WANTED_ADVICE), rows.map(([, word]) => word));
    assert.equal(rows.length, 4);
    for (const [, word, title, advice] of rows) {
        assert.equal(words.WANTED[word], title, word);
        assert.equal(words.WANTED_ADVICE[word], advice, word);
    }
});

test('words of the policy', () => {
    const decide = read('firmware/policy/decide.c');
    const reasons = [...decide.slice(0, decide.indexOf('};')).matchAll(/\] = "([^"]+)"/g)].map(([, word]) => word);
    same(policy.REFUSALS, reasons, 13);
    same(policy.METHODS, api.paths['/policy/test'].get.responses['200'].content['application/json'].schema.properties.wanted.items.enum, 3);
    const header = read('firmware/policy/document/policy_document.h');
    for (const word of [...Object.keys(policy.STATES), ...Object.keys(policy.ANTIPASSBACK)]) {
        assert.ok(header.includes(`"${word}"`), word);
    }
});

test('a text has the same translation on the screen and in the pages', () => {
    const read_catalogue = (path) => new Map([...read(path).matchAll(/^msgid "(.+)"\nmsgstr "(.*)"$/gm)]
        .map((match) => [match[1], match[2]]));
    for (const language of ['de', 'fr', 'es', 'ar', 'zh_CN']) {
        const screen = read_catalogue(`enroll/screen/po/${language}.po`);
        const pages = read_catalogue(`enroll/web/po/${language}.po`);
        const shared = [...screen.keys()].filter((text) => pages.has(text));
        assert.ok(shared.length >= 20, `${language}: ${shared.length} texts are shared`);
        for (const text of shared) {
            assert.equal(pages.get(text), screen.get(text), `${language}: ${text}`);
        }
    }
});

test('an unknown word is shown as it is', () => {
    assert.equal(words.word(words.HINTS, 'from-a-later-version'), 'from-a-later-version');
    assert.equal(words.word(words.HINTS, 'constructor'), 'constructor');
    assert.equal(words.word(words.HINTS, undefined), '');
});

test('no page has markup from a text, an inline script or style, or another server', () => {
    const folder = new URL('enroll/web/', ROOT);
    const files = readdirSync(folder, { recursive: true })
        .filter((name) => /^(pages|cockpit)\/.*\.(js|html|css|svg)$/.test(name));
    assert.ok(files.length > 30, `${files.length} files`);
    for (const name of files) {
        const text = readFileSync(new URL(name, folder), 'utf8');
        const found = /innerHTML|outerHTML|insertAdjacentHTML|document\.write|\beval\(|new Function/.exec(text) ??
            /<script(?![^>]*\bsrc=)|<style|\son[a-z]+="|\sstyle="|['"]style['"]?:/.exec(text) ??
            /(?<!xmlns="|SVG = ')https?:\/\//.exec(text);
        assert.equal(found, null, `${name}: ${found?.[0]}`);
    }
});

test('a module imports only what the other one exports', () => {
    const folder = new URL('enroll/web/pages/js/', ROOT);
    let imports = 0;
    for (const name of readdirSync(folder, { recursive: true }).filter((one) => one.endsWith('.js'))) {
        const file = new URL(name, folder);
        for (const [, names, from] of readFileSync(file, 'utf8').matchAll(/^import \{([^}]*)\} from '([^']+)';$/gm)) {
            const source = readFileSync(new URL(from, file), 'utf8');
            for (const one of names.split(',').map((text) => text.trim()).filter(Boolean)) {
                const exported = new RegExp(`^export (async )?(function|const|class|let) ${one.replace('$', '\\$')}\\b`, 'm');
                assert.match(source, exported, `${name} imports ${one} from ${from}`);
                imports += 1;
            }
        }
    }
    assert.ok(imports > 150, `${imports} imports were found`);
});
