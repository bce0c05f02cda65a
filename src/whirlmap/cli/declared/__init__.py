"""Options and help of every command, which import nothing that takes time: `whirlmap.cli.commands` does what they say."""
