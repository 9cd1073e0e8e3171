//! MCAP files from parts, for tests and for the fuzzer: neither chunks nor checksums.

/// File of one channel with messages 10 ms apart.
pub(super) fn file(encoding: &str, (schema, text): (&str, &[u8]), messages: &[&[u8]]) -> Vec<u8> {
    let mut records = vec![definition(1, schema, text), channel(1, 1, "/t", encoding)];
    records.extend((0..).zip(messages).map(|(row, data)| message(1, row * 10_000_000, data)));
    whole(&records.concat())
}

/// File of records.
pub(super) fn whole(records: &[u8]) -> Vec<u8> {
    [b"\x89MCAP0\r\n", records, &record(15, &[0; 4])].concat()
}

/// Record of a kind.
pub(super) fn record(kind: u8, body: &[u8]) -> Vec<u8> {
    [&[kind][..], &(body.len() as u64).to_le_bytes(), body].concat()
}

/// Record of a definition.
pub(super) fn definition(id: u16, encoding: &str, text: &[u8]) -> Vec<u8> {
    record(
        3,
        &[&id.to_le_bytes()[..], &counted(b"a/T"), &counted(encoding.as_bytes()), &counted(text)].concat(),
    )
}

/// Record of a channel.
pub(super) fn channel(id: u16, schema: u16, topic: &str, encoding: &str) -> Vec<u8> {
    let (topic, encoding) = (counted(topic.as_bytes()), counted(encoding.as_bytes()));
    record(4, &[&id.to_le_bytes()[..], &schema.to_le_bytes(), &topic, &encoding, &[0; 4]].concat())
}

/// Record of a message.
pub(super) fn message(channel: u16, log_time: u64, data: &[u8]) -> Vec<u8> {
    let time = log_time.to_le_bytes();
    record(5, &[&channel.to_le_bytes()[..], &[0; 4], &time, &time, data].concat())
}

/// Record of a chunk that states a size.
pub(super) fn chunk(compression: &str, size: u64, checksum: u32, data: &[u8]) -> Vec<u8> {
    let (size, length) = (size.to_le_bytes(), (data.len() as u64).to_le_bytes());
    let compression = counted(compression.as_bytes());
    record(6, &[&[0; 16][..], &size, &checksum.to_le_bytes(), &compression, &length, data].concat())
}

fn counted(bytes: &[u8]) -> Vec<u8> {
    [&(bytes.len() as u32).to_le_bytes()[..], bytes].concat()
}
