"""What a motion is: the rule that labels operating points, and what it rests on."""
