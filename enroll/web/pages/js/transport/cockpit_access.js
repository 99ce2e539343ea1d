/* Cards and the policy inside Cockpit: the functions of transport/http.js by D-Bus. */

import {Fault} from './fault.js';

/* Gives the faults of a call their codes: InvalidArgument means something else for each method. */
async function withCodes(promise, codes) {
    try {
        return await promise;
    } catch (error) {
        throw codes[error.code] ? new Fault(codes[error.code], { detail: error.detail }) : error;
    }
}

export function accessCalls(bus) {
    const change = { 'invalid-limits': 'invalid-credential', 'name-in-use': 'card-in-use' };
    return {
        async cards() {
            const [list] = await bus.call('ListCredentials', []);
            return new Map(list.map(([name, text]) => [name, JSON.parse(text)]));
        },
        async credential(name) { return JSON.parse((await bus.call('GetCredential', [name], 's'))[0]); },
        async changeCredential(name, patch) {
            const call = bus.call('SetCredential', [name, JSON.stringify(patch)], 'ss');
            return JSON.parse((await withCodes(call, change))[0]);
        },
        async policy() {
            const [text, revision] = await bus.call('GetPolicy', []);
            return { revision: Number(revision), document: text === '' ? null : JSON.parse(text) };
        },
        async storePolicy(revision, document) {
            const text = document === null ? '' : JSON.stringify(document);
            const call = bus.call('SetPolicy', [text, revision], 'st');
            const [stored, remarks] = await withCodes(call, { 'invalid-limits': 'invalid-policy' });
            return { revision: Number(stored), remarks };
        },
        async findings() { return (await bus.call('CheckPolicy', []))[0]; },
        async testAccess({ person, access_point = '', time, shown = [] }) {
            const call = bus.call('TestAccess', [person, access_point, time, shown], 'ssxas');
            const [answer] = await withCodes(call, { 'invalid-limits': 'invalid-parameter' });
            const { 'access-point': point, ...rest } = bus.plain(answer);
            return {...rest, access_point: point };
        },
    };
}
