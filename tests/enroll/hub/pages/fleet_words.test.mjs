/* Every word that the hub can say has a text for people. HUB_PAGES is the folder of the pages in the
 * build, where the files that they share with isotherm-web are beside their own. */

import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { pathToFileURL } from 'node:url';

const load = (path) => import(pathToFileURL(`${process.env.HUB_PAGES}/js/${path}`));
const words = await load('base/fleet_words.js');
const { FAULTS } = await load('base/words_faults.js');
const api = JSON.parse(readFileSync(new URL('../../../../enroll/hub/api/openapi.json', import.meta.url)));
const { schemas } = api.components;

const same = (table, wanted) => assert.deepEqual(Object.keys(table).sort(), [...wanted].sort());

test('words of doors and roles', () => {
    same(words.ATTENTION, schemas.Door.properties.attention.items.enum);
    same(words.MEMBERSHIPS, schemas.Door.properties.state.enum);
    same(words.ROLLOUTS, schemas.Rollout.properties.state.enum);
    same(words.DOOR_UPDATES, schemas.RolloutDoor.properties.state.enum);
    same(words.FLEET_ROLE_HELP, schemas.Role.enum);
});

test('codes of problems', () => {
    const said = new Set(['busy', 'internal', 'no-database', 'storage']);
    for (const methods of Object.values(api.paths)) {
        for (const { responses } of Object.values(methods)) {
            for (const [status, { description }] of Object.entries(responses)) {
                if (Number(status) >= 400) {
                    description.split(/[;:]| with /)[0].replace(/,$/, '').split(', ').forEach((code) => said.add(code));
                }
            }
        }
    }
    assert.ok(said.size > 25, `only ${said.size} codes were found`);
    for (const code of said) {
        assert.ok(code in words.FLEET_FAULTS || code in FAULTS, `the code ${code} has no words`);
    }
    for (const code of Object.keys(words.FLEET_FAULTS)) {
        assert.ok(said.has(code) || code === 'no-connection', `the document does not name ${code}`);
    }
});

test('a fault is said in the words of the hub, with the sentence that names the value', async () => {
    const { Fault, addFaultWords, faultText } = await load('transport/fault.js');
    const fault = (code, detail) => faultText(new Fault(code, { status: 409, detail }));
    assert.equal(fault('name-in-use', 'x'), 'Another person has this name.');
    addFaultWords(words.FLEET_FAULTS);
    assert.equal(fault('name-in-use', 'x'), 'This name is taken.');
    assert.equal(fault('invalid-value', 'zone: too long'), 'This value is not allowed. (zone: too long)');
    assert.equal(fault('not-known', 'what the hub says'), 'what the hub says');
});
